"""Convergence with the size of the solid elements about the contact."""

from __future__ import annotations

import xarray as xr

from impactlab.analysis.convergence import axis

AXIS = axis.Axis("element_size", "element_size", "the element size", lambda size: size)
_COMMENT = (
    "The elements of the 3-D model shrink about the contact, and the time step with them; beyond "
    "they keep their largest size. Models of the beam do not know the element size, and agree."
)


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a grid with three or more values of `element_size`."""
    return runs.sizes.get("element_size", 0) >= 3


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """The variables element_size_... of `axis.analysis`."""
    return axis.analysis(runs, AXIS, _COMMENT)
