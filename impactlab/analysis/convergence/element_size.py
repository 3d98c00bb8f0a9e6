"""Convergence with the size of the solid elements about the contact."""

from __future__ import annotations

from collections.abc import Callable

import xarray as xr

from impactlab.analysis.convergence import axis
from impactlab.model.parameters import ELEMENTS
from impactlab.types import Floats

SPACINGS: dict[str, Callable[[Floats], Floats]] = {
    "element_size": lambda size: size,
    "elements_per_radius": lambda count: 1.0 / count,
}
"""What tends to zero, by what is varied."""
_COMMENT = (
    "The elements of the 3-D model shrink about the contact, and the time step with them; beyond "
    "they keep their largest size. Models of the beam do not know the element size, and agree."
)


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a grid with three or more sizes of elements."""
    return any(runs.sizes.get(name, 0) >= 3 for name in ELEMENTS)


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """The variables element_size_... of `axis.analysis`."""
    dim = next(name for name in ELEMENTS if name in runs.dims)
    refined = axis.Axis("element_size", dim, "the element size", SPACINGS[dim])
    return axis.analysis(runs, refined, _COMMENT)
