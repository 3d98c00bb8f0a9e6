"""The asked responses of a runs dataset, with what is missing marked as missing."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.variables import RESPONSES, status_bits


def listed(runs: xr.Dataset, attribute: str) -> list[str]:
    """A list attribute: netCDF gives a list of one back as a plain string."""
    return [str(entry) for entry in np.atleast_1d(runs.attrs[attribute])]


def relevant_bits(name: str) -> int:
    """The status bits that make this response missing."""
    return status_bits([name] if name in RESPONSES else [])


def missing(runs: xr.Dataset) -> xr.DataArray:
    """True where a run gives no usable number: not finite, or its status says so.

    Returns bool on (response, *design dims). Raises ValueError when an asked response is not
    among the variables.
    """
    return _missing(runs, _stacked(runs))


def usable(runs: xr.Dataset) -> xr.DataArray:
    """The asked responses in SI units, NaN where missing, on (response, *design dims).

    Coordinates response_units and response_long_name say what each one is. Raises ValueError
    when an asked response is not among the variables.
    """
    stacked = _stacked(runs)
    found = [runs[name].attrs for name in stacked["response"].values]
    labels = {
        f"response_{key}": ("response", [str(attrs.get(key, "")) for attrs in found])
        for key in ("units", "long_name")
    }
    return stacked.where(~_missing(runs, stacked)).assign_coords(labels)


def _stacked(runs: xr.Dataset) -> xr.DataArray:
    names = listed(runs, "responses")
    if absent := [name for name in names if name not in runs.data_vars]:
        raise ValueError(
            f"the runs of study {runs.attrs.get('study', '?')!r} hold no {', '.join(absent)}, "
            "which its attribute `responses` lists: solve the study again"
        )
    stacked = runs[names].compute().to_array("response", name="value").astype(float)
    stacked["response"].attrs = {"long_name": "response"}
    return stacked


def _missing(runs: xr.Dataset, stacked: xr.DataArray) -> xr.DataArray:
    bits = [relevant_bits(str(name)) for name in stacked["response"].values]
    by_status = (runs["status"].compute() & xr.DataArray(bits, dims="response")) != 0
    finite = xr.DataArray(np.isfinite(stacked.values), stacked.coords, stacked.dims)
    return (by_status | ~finite).transpose("response", ...)
