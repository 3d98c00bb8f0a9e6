"""Convergence with the time step at fixed nodes."""

from __future__ import annotations

import xarray as xr

from impactlab.analysis.convergence import axis

AXIS = axis.Axis("time_step", "courant", "the time step", lambda courant: courant)
_COMMENT = (
    "The nodes stay the same, so that the order is that of time alone; the limit is the answer of "
    "these nodes at an infinitesimal time step, not that of the beam."
)


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a grid with three or more values of `courant`."""
    return runs.sizes.get("courant", 0) >= 3


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """The variables time_step_... of `axis.analysis`; the time step is proportional to courant."""
    return axis.analysis(runs, AXIS, _COMMENT)
