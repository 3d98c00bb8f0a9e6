"""The runs of a design, as any solver reads them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr


def varied_names(design: xr.Dataset) -> tuple[str, ...]:
    """Return the varied parameters, in the order of the study."""
    return tuple(str(name) for name in np.atleast_1d(design.attrs["varied"]))


def run_shape(design: xr.Dataset) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Return the dimensions that number the runs and their sizes; the last one varies fastest.

    They are in the study's order: netCDF does not keep the order of a dataset's own dimensions.
    """
    dims = (str(dim) for name in varied_names(design) for dim in design[name].dims)
    once = tuple(dict.fromkeys(dims))
    return once, tuple(design.sizes[dim] for dim in once)


def run_count(design: xr.Dataset) -> int:
    """Return the number of runs."""
    return math.prod(run_shape(design)[1])


def flattened(design: xr.Dataset, name: str, runs: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return a parameter in these runs, numbered along the dimensions in C order: shape (runs,)."""
    dims, shape = run_shape(design)
    places = np.unravel_index(runs, shape)
    own = tuple(places[dims.index(str(dim))] for dim in design[name].dims)
    values: np.ndarray[Any, Any] = np.broadcast_to(design[name].values[own], runs.shape)
    return values
