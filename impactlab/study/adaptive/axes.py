"""The axes of the discretisation, and how uncertain an answer is on each rung of one."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.uncertainty import numerical_uncertainty

Array = NDArray[np.float64]

AXES = ("nodes", "points", "courant")


def uncertainty(values: xr.DataArray, axis: str) -> xr.DataArray:
    """Of the value on every rung, in its unit, infinite where nothing can be said.

    values: on (response, case, axis), the rungs rising in cost. Points and time step are judged
    by the differences to the costliest rung: once fibres yield, the error falls by no power of the
    points; and what the time step changes at fixed nodes is too little (some 1e-6) and too
    irregular for one.
    """
    finest_first = values.isel({axis: slice(None, None, -1)})
    rungs = finest_first[axis].values.astype(float)
    judge = partial(_by_spacing, nodes=rungs) if axis == "nodes" else points.numerical_uncertainty
    found: xr.DataArray = xr.apply_ufunc(
        judge, finest_first, input_core_dims=[[axis]], output_core_dims=[[axis]], vectorize=True
    )
    return found.isel({axis: slice(None, None, -1)}).fillna(np.inf)


def _by_spacing(values: Array, nodes: Array) -> Array:
    return numerical_uncertainty(values, 1.0 / (nodes - 1.0)).amounts
