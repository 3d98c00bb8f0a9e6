"""The responses of a study's runs, and what is missing of them and why."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.methods.runs import listed
from impactlab.variables import status_bits


def usable(runs: xr.Dataset, response: str | None = None) -> xr.DataArray:
    """Return the requested responses in SI units on (response, *design dims).

    NaN where a run gives no usable number: it is not finite, or its status excludes it. Coordinates
    response_units and response_long_name describe each one. response: this one alone, without the
    coordinates on `run`, so that memory holds little beside it. Raises ValueError when a requested
    response is not among the variables.
    """
    described = labels(runs, *([] if response is None else [response]))
    names: list[str] = described["response"][1]
    if response is None:
        values = runs[names].compute().to_array("response", name="value")
    else:
        alone = runs[response].rename("value")
        of_runs = [name for name, coordinate in alone.coords.items() if "run" in coordinate.dims]
        values = alone.drop_vars(of_runs).compute().expand_dims(response=[response])
    values = values.astype(float, copy=False).assign_coords(described)
    status = xr.DataArray(runs["status"].variable.compute())
    bits = np.array([status_bits([name]) for name in names], status.dtype)
    excluded = (status & xr.DataArray(bits, dims="response")) != 0
    good = np.isfinite(values) & ~excluded.transpose(*values.dims)
    return values if good.all() else values.where(good)


def labels(runs: xr.Dataset, *names: Any) -> dict[str, Any]:
    """Return the coordinates of these responses, of all requested ones by default.

    Raises ValueError when one is not among the variables.
    """
    of = [str(name) for name in names or listed(runs, "responses")]
    if absent := [name for name in of if name not in runs.data_vars]:
        raise ValueError(
            f"the runs of study {runs.attrs.get('study', '?')!r} hold no {', '.join(absent)}, "
            "which its attribute `responses` lists: solve the study again"
        )
    coordinates: dict[str, Any] = {"response": ("response", of, {"long_name": "response"})}
    for key in ("units", "long_name"):
        coordinates[f"response_{key}"] = (
            "response",
            [str(runs[name].attrs.get(key, "")) for name in of],
        )
    return coordinates
