"""The solver of studies in which some runs are of the 3-D FE model, beside the beam models."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.solver import quarter_mesh
from impactlab.fem3d.solver import solve as solve_alone
from impactlab.fem3d.solver.jit import SOURCES_HASH as SOLID_HASH
from impactlab.fem3d.solver.responses import surface_reach
from impactlab.fem3d.study.cases import impact_of, is_solid, kernel_cases, table, work
from impactlab.model.impact import Impact
from impactlab.simulate import solve as solve_cases
from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.netcdf import Columns
from impactlab.study.solvers import Solver, flattened, impact, run_shape, varied_names
from impactlab.study.store import OutputSpec
from impactlab.variables import FAILURES, HISTORIES, RESPONSES, WITNESS, described

log = logging.getLogger(__name__)

STOPPED = FAILURES["stopped"][0]
_LARGER = 1.5
"""A patch of matched nodes over one that the contact has outgrown."""
_STEPS = 10_001
"""Samples of a history before it is brought to the study's times: closer than the time steps."""


def solve_one(case: Any, samples: int) -> dict[str, Any]:
    """Return responses, `status`, `remarks` and histories (samples,) of a record by name.

    A patch that the contact outgrows is enlarged until there is no room for more. What the 3-D
    model does not know is NaN; so is all of a run that stopped before its time, and `status` says
    so. Raises KeyboardInterrupt where the run was interrupted: it is no answer.
    """
    given = {"status": STOPPED, "remarks": 0}
    try:
        run = _solved(impact_of(case), case["element_size"].item(), case["duration"].item())
    except ValueError as error:  # no mesh of this size, or no larger patch
        log.warning("a 3-D run was not possible: %s", error)
        return given
    stopped = str(run.attrs.get("stopped", ""))
    if stopped.startswith("interrupted"):
        raise KeyboardInterrupt
    if stopped:
        log.warning("a 3-D run stopped: %s", stopped)
        return given | {"status": int(run["status"]) | STOPPED}
    found = {name: float(run[name]) for name in RESPONSES if name in run}
    histories = _histories(run, case["duration"].item(), samples)
    own = {"plastic_zone_radius": surface_reach(run)}
    return given | found | own | histories | {"status": int(run["status"])}


def _solved(impact: Impact, size: float, duration: float) -> xr.Dataset:
    patch = quarter_mesh(impact, element_size=size).patch
    while True:
        run = solve_alone(impact, element_size=size, duration=duration, patch=patch, samples=_STEPS)
        if "patch_needed" not in run.attrs:
            return run
        patch = _LARGER * patch
        log.info(
            "a 3-D run begins again with a patch of %.3g mm: %s", 1e3 * patch, run.attrs["stopped"]
        )


def _histories(run: xr.Dataset, duration: float, samples: int) -> dict[str, Any]:
    """Return histories on the study's times; the last may lie within a step of the run's end."""
    if not samples:
        return {}
    times = np.linspace(0.0, duration, samples)
    return {
        name: np.interp(times, run["time"].values, run[name].values)
        for name in HISTORIES
        if name in run
    }


Array = np.ndarray[Any, Any]

VERSION = hashlib.sha256(f"{SOURCES_HASH} {SOLID_HASH}".encode()).hexdigest()
"""Hash of the sources of the kernels and of the 3-D FE model."""


def columns(design: xr.Dataset) -> tuple[str, ...]:
    """Return the columns of the beam models, and those of the 3-D FE model alone."""
    return (*impact.columns(design), *WITNESS)


def failures(design: xr.Dataset) -> int:
    """Return the failure bits of the beam models."""
    return impact.failures(design)


def cases(design: xr.Dataset, runs: Array) -> Array:
    """Return the table of fem3d.study.cases of these runs.

    Raises ValueError naming the run when the model refuses a value.
    """
    varied = {name: flattened(design, name, runs) for name in varied_names(design)}
    duration = design["duration"].item()
    return table(*impact.base(design), duration=duration, varied=varied, first_run=int(runs[0]))


def cost(cases: Array) -> Array:
    """Return the cost in node-steps of the paper's beam, converted from seconds for 3-D runs."""
    return work(cases)


def values(cases: Array, form: OutputSpec) -> int:
    """Return the number of values of the beam models."""
    return impact.values(cases, form)


def solve(cases: Array, form: OutputSpec) -> Columns:
    """Return the answers of the kernels and of the 3-D FE model, in the order of the cases."""
    solid = is_solid(cases)
    found = solve_cases(kernel_cases(cases), samples=form.samples).columns()
    columns = {name: _spread(values, ~solid) for name, values in found.items()}
    columns |= {name: np.full(cases.size, np.nan) for name in WITNESS}
    for at in np.flatnonzero(solid):
        for name, value in solve_one(cases[at], form.samples).items():
            columns[name][at] = value
    return columns


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """Return the answers of a design's runs, in its order, with labels and provenance."""
    dims, shape = run_shape(design)
    own = {name: (dims, answers[name].reshape(shape)) for name in WITNESS}
    return described(impact.labelled(design, answers).assign(own))


def _spread(values: Array, where: Array) -> Array:
    """Return rows of (cases, ...): those given where `where` holds, else NaN (0 for integers)."""
    missing = np.nan if values.dtype.kind == "f" else 0
    rows = np.full((where.size, *values.shape[1:]), missing, dtype=values.dtype)
    rows[where] = values
    return rows


SOLVER = Solver(VERSION, columns, failures, cases, cost, values, solve, labelled)
