"""What is read off a design, whatever solves it."""

from __future__ import annotations

import math
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


def run_count(design: xr.Dataset) -> int:
    """How many runs there are."""
    return math.prod(run_shape(design)[1])


def flattened(design: xr.Dataset, name: str, runs: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """A parameter's value in these runs, numbered with the dimensions in C order: shape (runs,)."""
    dims, shape = run_shape(design)
    places = np.unravel_index(runs, shape)
    own = tuple(places[dims.index(str(dim))] for dim in design[name].dims)
    values: np.ndarray[Any, Any] = np.broadcast_to(design[name].values[own], runs.shape)
    return values
