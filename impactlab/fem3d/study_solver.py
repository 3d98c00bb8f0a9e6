"""The solver of studies in which some runs are of the 3-D FE model, beside the beam models.

The record of a run is that of the kernels (solver.types.CASE) with the size of the solid elements.
What a run does not depend on is zero in it, so that runs which differ in that alone are one case.
"""

import hashlib
import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.lib.recfunctions import require_fields

from impactlab.fem3d.plan import MOST_TIME, cost_of
from impactlab.fem3d.solver import Cost, impact_mesh
from impactlab.fem3d.solver import solve as solve_alone
from impactlab.fem3d.solver.compiler import COMPILER
from impactlab.fem3d.solver.dataset import IMPACT_PARAMETERS
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.fem3d.solver.evaluation import plastic_reach
from impactlab.fem3d.wing import SIZES, SOLID, VARIABLES
from impactlab.methods.runs import listed
from impactlab.model import cost
from impactlab.model.case_table import case_table
from impactlab.model.checks import column, positive
from impactlab.model.contact_compliance import TIMOSHENKO_OPTIONS
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import OTHER_SECTION, RATIO_DAMPED_BEAM, Impact, paper_impact
from impactlab.model.parameters import with_values
from impactlab.solve import solve as solve_cases
from impactlab.solver import BEAM_MODELS, FLOW_LAWS, SUPPORTS
from impactlab.solver.jit import SOURCES_HASH
from impactlab.solver.types import CASE
from impactlab.study.shard import Array, Columns
from impactlab.study.solvers import flattened, kernels, run_number, run_shape
from impactlab.study.store import OutputSpec
from impactlab.variables import FAILURES, HISTORIES, RESPONSES, described

log = logging.getLogger(__name__)

SOLID_CASE = np.dtype((np.record, [*CASE.descr, ("element_size", float)]))  # the table's records
SOLID_MODEL = len(BEAM_MODELS)  # number of the 3-D FE model, after those of the kernels
_BEAM_MODELS_ONLY = (
    *("contact", "load", "compliance", "bending_compliance", "crowding"),
    *("shear_coefficient", "shear_stiffness", "axis_held_left", "axis_held_right"),
    *("nodes", "points", "rule", "scheme", "courant"),
)
"""Fields that the 3-D FE model does not use."""
_USUAL_SIZE = 1e-3  # of elements, in m, that saves time
_STEPS = 10_001  # samples of a history until it has the study's times: closer than the time steps


def table(
    impact: Impact, grid: Discretisation, *, varied: Mapping[str, Any], **options: Any
) -> Array:
    """Return one record per run, each run checked; arguments as those of simulate.case_table.

    Raises ValueError naming the run and its field when the model refuses a value, or a run of the
    3-D FE model has neither element_size nor elements_per_radius.
    """
    models = np.asarray(varied.get("beam_model", [impact.beam_model]))
    plain = dict(varied)
    # what a table of beams takes; the bodies are what they are in 3-D
    for name, stand_in in (TIMOSHENKO_OPTIONS | {"beam_model": BEAM_MODELS[0]}).items():
        if {"beam_model", name} & plain.keys():
            entries = np.asarray(varied.get(name, [getattr(impact, name)]))
            plain[name] = np.where(models == SOLID, stand_in, entries)
        elif impact.beam_model == SOLID:
            impact, _ = with_values(impact, grid, {name: stand_in})
    records: Array = require_fields(case_table(impact, grid, varied=plain, **options), SOLID_CASE)
    solid = np.broadcast_to(models == SOLID, records.shape)
    if not solid.any():
        return records
    _refuse_beams(records[solid])
    records["beam_model"][solid] = SOLID_MODEL
    for name in _BEAM_MODELS_ONLY:
        records[name][solid] = 0
    for name in SIZES:
        values = varied.get(name, [getattr(grid, name)])
        if not any(value is None for value in values):
            break
    else:
        raise ValueError("Discretisation.element_size: is required for the solid model")
    sizes = np.broadcast_to(positive("Discretisation", name, column(values)), solid.shape)[solid]
    if name == "elements_per_radius":
        sizes = np.array([contact_radius(_impact_of(case)) for case in records[solid]]) / sizes
    records["element_size"][solid] = sizes
    return records


def _refuse_beams(records: Array) -> None:
    """Raise ValueError where a beam is none of the 3-D FE model's."""
    if records["beam_shape"].any():
        raise ValueError(f"beam_model = {SOLID!r}: must be another one {OTHER_SECTION}")
    if records["damping_ratio"].any():
        raise ValueError(f"beam_model = {SOLID!r}: must be {RATIO_DAMPED_BEAM}")
    if records["beam_flow_law"].any():
        raise ValueError(f"beam_model = {SOLID!r}: hardens linearly: take beam_flow_law out")
    if np.any(records["strikes"] > 1) or records["further"].any():
        raise ValueError(f"beam_model = {SOLID!r}: has one strike by one sphere: change it")


def is_solid(cases: Array) -> Array:
    """Return which cases are of the 3-D FE model, (cases,)."""
    return np.asarray(cases["beam_model"] == SOLID_MODEL)


def _impact_of(case: Any) -> Impact:
    """Return the impact of a record of the 3-D FE model."""
    values: dict[str, Any] = {name: case[name].item() for name in IMPACT_PARAMETERS}
    for name in ("support_left", "support_right"):
        values[name] = SUPPORTS[int(values[name])]
    values["beam_flow_law"] = FLOW_LAWS[0]
    return with_values(paper_impact(), Discretisation(), values | {"beam_model": SOLID})[0]


def work(cases: Array) -> Array:
    """Return the estimated time of each run in node-steps; 0 for repetitions of a run."""
    estimates = _priced(cases, cost.work, lambda run: cost.A_SECOND * run.cpu_seconds)
    _, first = np.unique(cases.view(f"V{cases.dtype.itemsize}"), return_index=True)
    once = np.zeros(cases.size)
    once[first] = estimates[first]
    return once


def memory(cases: Array) -> Array:
    """Return the estimated memory of each run in bytes."""
    return _priced(cases, cost.memory, lambda run: run.memory_bytes)


def usual(case: Array, duration: float) -> Array:
    """Return the record of the usual run that a record is compared with: 3-D beside 3-D."""
    impact = paper_impact()
    if is_solid(case).all():
        impact = replace(impact, beam_model=SOLID)
    return table(impact, Discretisation(element_size=_USUAL_SIZE), duration=duration, varied={})


def _priced(
    cases: Array, of_beams: Callable[[Array], Array], of_solid: Callable[[Cost], float]
) -> Array:
    estimates, solid = np.zeros(cases.size), is_solid(cases)
    estimates[~solid] = of_beams(require_fields(cases[~solid], CASE))
    estimates[solid] = [of_solid(_cost(case.tobytes())) for case in cases[solid]]
    return estimates


@lru_cache(maxsize=4096)
def _cost(record: bytes) -> Cost:
    """Return a run's cost, the least one if above an hour or memory; zeros where no mesh fits."""
    case = np.frombuffer(record, dtype=SOLID_CASE)[0]
    size, duration = case["element_size"].item(), case["duration"].item()
    try:
        return cost_of(_impact_of(case), size, duration, longest=MOST_TIME)[0]
    except ValueError:  # the run will say so in its status
        return Cost(0, 0, 0.0, 0)


def solve_one(case: Any, samples: int) -> dict[str, Any]:
    """Return responses, `status`, `remarks` and histories (samples,) of a record by name.

    A patch that the contact outgrows is enlarged until there is no room for more. What the 3-D
    model does not know is NaN; so is all of a run that stopped before its time, and `status` says
    so. Raises KeyboardInterrupt where the run was interrupted: it is no answer.
    """
    stopped = FAILURES["stopped"][0]
    answers: dict[str, Any] = {"status": stopped, "remarks": 0}
    solid_impact = _impact_of(case)
    size, duration = case["element_size"].item(), case["duration"].item()
    options: dict[str, Any] = {"element_size": size, "duration": duration, "samples": _STEPS}
    begun = time.thread_time()
    try:
        patch = impact_mesh(solid_impact, element_size=size).patch
        while "patch_needed" in (run := solve_alone(solid_impact, patch=patch, **options)).attrs:
            patch = 1.5 * patch
            again = "a 3-D run begins again with a patch of %.3g mm: %s"
            log.info(again, 1e3 * patch, run.attrs["stopped"])
            begun = time.thread_time()
        seconds = time.thread_time() - begun
    except ValueError as error:  # no mesh of this size, or no larger patch
        log.warning("a 3-D run was not possible: %s", error)
        return answers
    if reason := str(run.attrs.get("stopped", "")):
        if reason.startswith("interrupted"):
            raise KeyboardInterrupt
        log.warning("a 3-D run stopped: %s", reason)
        return answers | {"status": int(run["status"]) | stopped}
    answers |= {name: float(run[name]) for name in RESPONSES if name in run}
    if samples:  # the last time may lie within a step of the run's end
        times = np.linspace(0.0, duration, samples)
        for name in HISTORIES:
            if name in run:
                answers[name] = np.interp(times, run["time"].values, run[name].values)
    for name, along in (("plastic_zone_radius", 0), ("plastic_zone_depth", 2)):
        answers[name] = plastic_reach(run, along)
    return answers | {"processor_time": seconds, "status": int(run["status"])}


def cases(design: xr.Dataset, runs: Array) -> Array:
    """Return the table of these runs. Raises ValueError naming a run that the model refuses."""
    varied = {name: flattened(design, name, runs) for name in listed(design, "varied")}
    duration = design["duration"].item()
    first = run_number(design, runs[0])
    return table(*kernels.base(design), duration=duration, varied=varied, first_run=first)


def solve(cases: Array, form: OutputSpec) -> Columns:
    """Return the answers of the kernels and of the 3-D FE model, in the order of the cases."""
    solid = is_solid(cases)
    answers = solve_cases(require_fields(cases[~solid], CASE), samples=form.samples)
    columns = {}
    for name, values in answers.items():
        missing = np.nan if values.dtype.kind == "f" else 0
        columns[name] = np.full((cases.size, *values.shape[1:]), missing, dtype=values.dtype)
        columns[name][~solid] = values
    columns |= {name: np.full(cases.size, np.nan) for name in VARIABLES}
    for row in np.flatnonzero(solid):
        for name, value in solve_one(cases[row], form.samples).items():
            columns[name][row] = value
    return columns


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """Return the answers of a design's runs, in its order, with labels and provenance."""
    dims, shape = run_shape(design)
    variables = {name: (dims, answers[name].reshape(shape)) for name in VARIABLES}
    return described(kernels.labelled(design, answers).assign(variables))


SOLVER = replace(
    kernels.SOLVER,
    version=hashlib.sha256(f"{SOURCES_HASH} {COMPILER.sources_hash}".encode()).hexdigest(),
    columns=lambda design: (*kernels.columns(design), *VARIABLES),
    cases=cases,
    cost=work,
    solve=solve,
    labelled=labelled,
)
