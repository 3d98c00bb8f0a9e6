"""One run of the 3-D model as a study keeps it; one that fails is an answer, too."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.solver import quarter_mesh, solve
from impactlab.fem3d.solver.result.zone import surface_reach
from impactlab.fem3d.study.cases import impact_of
from impactlab.model.impact import Impact
from impactlab.variables import FAILURES, HISTORIES, RESPONSES

log = logging.getLogger(__name__)

STOPPED = FAILURES["stopped"][0]
_LARGER = 1.5
"""A patch of matched nodes over one that the contact has outgrown."""
_STEPS = 10_001
"""Samples of a history before it is brought to the study's times: closer than the time steps."""


def answers(case: Any, samples: int) -> dict[str, Any]:
    """Responses, `status`, `remarks` and histories (samples,) of a record of SOLID_CASE by name.

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
        run = solve(impact, element_size=size, duration=duration, patch=patch, samples=_STEPS)
        if "patch_needed" not in run.attrs:
            return run
        patch = _LARGER * patch
        log.info(
            "a 3-D run begins again with a patch of %.3g mm: %s", 1e3 * patch, run.attrs["stopped"]
        )


def _histories(run: xr.Dataset, duration: float, samples: int) -> dict[str, Any]:
    """On the times of the study, of which the last may lie within a step of the run's end."""
    if not samples:
        return {}
    times = np.linspace(0.0, duration, samples)
    return {
        name: np.interp(times, run["time"].values, run[name].values)
        for name in HISTORIES
        if name in run
    }
