"""What runs of the 3-D model cost, in the unit of the kernels' node-steps."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from distributed.system import MEMORY_LIMIT

from impactlab.fem3d.solver import Cost, estimate, least_cost, quarter_mesh
from impactlab.fem3d.study.cases import SOLID_CASE, impact_of, is_solid, kernel_cases
from impactlab.model import cost

Array = np.ndarray[Any, Any]
_LONG = 3600.0
"""Seconds of a run from which on no mesh is made to tell how long it takes."""


def work(cases: Array) -> Array:
    """Estimated time of each run, in node-steps; of a run that is listed again, nothing."""
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
    """Estimated bytes that each run takes."""
    found = np.zeros(cases.size)
    solid = is_solid(cases)
    found[~solid] = cost.memory(kernel_cases(cases))
    found[solid] = [float(of_solid(case).memory_bytes) for case in cases[solid]]
    return found


def of_solid(case: Any) -> Cost:
    """Elements, steps, seconds and bytes of one 3-D run; nothing where no mesh fits.

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
