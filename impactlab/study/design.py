"""What is read off a design, whatever solves it."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr


def varied_names(design: xr.Dataset) -> tuple[str, ...]:
    """The varied parameters, in the order of the study."""
    return tuple(str(name) for name in np.atleast_1d(design.attrs["varied"]))


def run_shape(design: xr.Dataset) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """The dimensions that number the runs and their sizes; the last one varies fastest.

    In the study's order: the order of a dataset's own dimensions is not kept by netCDF.
    """
    dims = (str(dim) for name in varied_names(design) for dim in design[name].dims)
    once = tuple(dict.fromkeys(dims))
    return once, tuple(design.sizes[dim] for dim in once)


def flattened(design: xr.Dataset, name: str) -> np.ndarray[Any, Any]:
    """A parameter's value in each run, dimensions in C order: shape (runs,)."""
    sizes = dict(zip(*run_shape(design), strict=True))
    values: np.ndarray[Any, Any] = design[name].variable.set_dims(sizes).values.ravel()
    return values
