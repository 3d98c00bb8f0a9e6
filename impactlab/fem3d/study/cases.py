"""The table of cases of a study in which some runs are of the 3-D FE model, and what they cost.

A record is that of the kernels (solver.types.CASE) with the size of the solid elements. What a run
does not depend on is zero in it, so that runs which differ in that alone are one case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from distributed.system import MEMORY_LIMIT

from impactlab.fem3d.solver import Cost, estimate, least_cost, quarter_mesh
from impactlab.fem3d.solver.mesh.estimates import contact_radius
from impactlab.model import cost
from impactlab.model.checks import column, positive
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import SOLID, Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.simulate import case_table
from impactlab.solver import BEAM_MODELS
from impactlab.solver.types import CASE

Array = np.ndarray[Any, Any]

SOLID_CASE = np.dtype((np.record, [*CASE.descr, ("element_size", float)]))
"""Record type of the table."""
SOLID_MODEL = len(BEAM_MODELS)
"""Number of the 3-D FE model, after those of the kernels."""
_BEAM_MODELS_ONLY = (
    *("contact", "shear_coefficient"),
    *("nodes", "points", "rule", "scheme", "courant"),
)
"""Fields that the 3-D FE model does not use."""


def table(
    impact: Impact,
    discretisation: Discretisation,
    *,
    duration: float,
    varied: Mapping[str, Any],
    first_run: int = 0,
) -> Array:
    """Return one record per run, each run checked; arguments as those of simulate.case_table.

    Raises ValueError naming the run and its field when the model refuses a value, or a run of the
    3-D FE model has neither element_size nor elements_per_radius.
    """
    models = np.asarray(varied.get("beam_model", [impact.beam_model]))
    plain = dict(varied)
    if "beam_model" in plain:
        plain["beam_model"] = np.where(models == SOLID, BEAM_MODELS[0], models)
    elif impact.beam_model == SOLID:
        impact = replace(impact, beam_model=BEAM_MODELS[0])
    known = case_table(impact, discretisation, duration=duration, varied=plain, first_run=first_run)
    cases = np.zeros(known.size, dtype=SOLID_CASE)
    for name in CASE.names or ():
        cases[name] = known[name]
    solid = np.broadcast_to(models == SOLID, cases.shape)
    if solid.any():
        cases["beam_model"][solid] = SOLID_MODEL
        for name in _BEAM_MODELS_ONLY:
            cases[name][solid] = 0
        cases["element_size"][solid] = _sizes(discretisation, varied, cases, solid)
    return cases


def _sizes(
    discretisation: Discretisation, varied: Mapping[str, Any], cases: Array, solid: Array
) -> Array:
    """Return the element size in m of each run of the 3-D FE model."""

    def given(name: str) -> Array | None:
        values = varied.get(name, [getattr(discretisation, name)])
        if any(value is None for value in values):
            return None
        return np.broadcast_to(positive("Discretisation", name, column(values)), solid.shape)[solid]

    if (sizes := given("element_size")) is not None:
        return sizes
    if (counts := given("elements_per_radius")) is None:
        raise ValueError("Discretisation.element_size: is required for the solid model")
    return np.array([contact_radius(impact_of(case)) for case in cases[solid]]) / counts


def is_solid(cases: Array) -> Array:
    """Return which cases are of the 3-D FE model, (cases,)."""
    return np.asarray(cases["beam_model"] == SOLID_MODEL)


def kernel_cases(cases: Array) -> Array:
    """Return the cases of the beam models as the kernels take them."""
    beams = cases[~is_solid(cases)]
    found = np.zeros(beams.size, dtype=CASE)
    for name in CASE.names or ():
        found[name] = beams[name]
    return found


def impact_of(case: Any) -> Impact:
    """Return the impact of a record of the 3-D FE model."""
    values = {name: case[name].item() for name in _IMPACT}
    return with_values(paper_impact(), Discretisation(), values | {"beam_model": SOLID})[0]


_IMPACT = [
    name
    for name, entry in PARAMETERS.items()
    if entry.path[0] == "impact" and name not in (*_BEAM_MODELS_ONLY, "beam_model")
]


_LONG = 3600.0
"""Duration of a run in s beyond which no mesh is made to estimate it."""


def work(cases: Array) -> Array:
    """Return the estimated time of each run in node-steps; 0 for a run that is listed again."""
    found = np.zeros(cases.size)
    solid = is_solid(cases)
    found[~solid] = cost.work(kernel_cases(cases))
    found[solid] = [cost.A_SECOND * of_solid(case).cpu_seconds for case in cases[solid]]
    _, first = np.unique(cases.view(f"V{cases.dtype.itemsize}"), return_index=True)
    again = np.ones(cases.size, dtype=bool)
    again[first] = False
    found[again] = 0.0
    return found


def memory(cases: Array) -> Array:
    """Return the estimated memory of each run in bytes."""
    found = np.zeros(cases.size)
    solid = is_solid(cases)
    found[~solid] = cost.memory(kernel_cases(cases))
    found[solid] = [float(of_solid(case).memory_bytes) for case in cases[solid]]
    return found


def of_solid(case: Any) -> Cost:
    """Return elements, steps, seconds and bytes of one 3-D run; zeros where no mesh fits.

    Of one that is long or large, what it takes at the least: its mesh may not fit memory.
    """
    return _of_bytes(case.tobytes())


@lru_cache(maxsize=4096)
def _of_bytes(record: bytes) -> Cost:
    case = np.frombuffer(record, dtype=SOLID_CASE)[0]
    impact = impact_of(case)
    size, duration = case["element_size"].item(), case["duration"].item()
    try:
        least = least_cost(impact, element_size=size, duration=duration)
        if least.cpu_seconds > _LONG or least.memory_bytes > MEMORY_LIMIT:
            return least
        mesh = quarter_mesh(impact, element_size=size)
    except ValueError:  # the run will say so in its status
        return Cost(0, 0, 0.0, 0)
    return estimate(mesh, impact, duration=duration)
