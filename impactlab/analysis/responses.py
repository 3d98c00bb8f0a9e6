"""The requested responses of a runs dataset, and a count of what is missing and why."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.variables import FAILED, FAILURES, status_bits


def listed(runs: xr.Dataset, attribute: str) -> list[str]:
    """Return a list attribute as a list: netCDF gives a list of one back as a plain string."""
    return [str(entry) for entry in np.atleast_1d(runs.attrs[attribute])]


def usable(runs: xr.Dataset) -> xr.DataArray:
    """Return the requested responses in SI units on (response, *design dims).

    NaN where a run gives no usable number: it is not finite, or its status excludes it. Coordinates
    response_units and response_long_name describe each one. Raises ValueError when a requested
    response is not among the variables.
    """
    names = listed(runs, "responses")
    if absent := [name for name in names if name not in runs.data_vars]:
        raise ValueError(
            f"the runs of study {runs.attrs.get('study', '?')!r} hold no {', '.join(absent)}, "
            "which its attribute `responses` lists: solve the study again"
        )
    values = runs[names].compute().to_array("response", name="value").astype(float)
    values["response"].attrs = {"long_name": "response"}
    labels = {
        f"response_{key}": ("response", [str(runs[name].attrs.get(key, "")) for name in names])
        for key in ("units", "long_name")
    }
    good = np.isfinite(values) & ~_excluded(runs, values)
    return values.where(good).assign_coords(labels)


def _excluded(runs: xr.Dataset, values: xr.DataArray) -> xr.DataArray:
    """Return True, on the dimensions of the values, where its status makes a response missing."""
    bits = [status_bits([name]) for name in values["response"].values]
    excluded = (runs["status"].compute() & xr.DataArray(bits, dims="response")) != 0
    return excluded.transpose(*values.dims)


UNEXPLAINED = ("unexplained", "a response is missing and the run's status does not say why")


def failures(runs: xr.Dataset) -> xr.Dataset:
    """Count the runs: in all, failed, failed by reason, and missing a response.

    Returns number_of_runs, number_of_failed_runs, failed_runs (reason), missing_runs (response).
    A run that failed for two reasons counts under both. `reason` holds the names of the status
    flags and "unexplained"; reason_long_name explains them.
    """
    values, status = usable(runs), runs["status"].compute()
    gaps = values.isnull().drop_vars(["response_units", "response_long_name"])
    unexplained = (gaps & ~_excluded(runs, values)).any("response")
    failed = ((status & FAILED) != 0) | unexplained
    reasons = [((status & bit) != 0, name, words) for name, (bit, words) in FAILURES.items()]
    by_reason, names, words = zip(*reasons, (unexplained, *UNEXPLAINED), strict=True)
    dataset = xr.Dataset(
        {
            "number_of_runs": status.size,
            "number_of_failed_runs": int(failed.sum()),
            "failed_runs": ("reason", [int(found.sum()) for found in by_reason]),
            "missing_runs": gaps.sum([dim for dim in gaps.dims if dim != "response"]),
        },
        {
            "reason": ("reason", list(names), {"long_name": "reason of failure"}),
            "reason_long_name": ("reason", list(words)),
        },
    )
    for name, long_name in _COUNTS.items():
        dataset[name].attrs = {"long_name": long_name, "units": "1"}
    return dataset


_COUNTS = {
    "number_of_runs": "runs in the study",
    "number_of_failed_runs": "runs that miss a response, or whose status says that they failed",
    "failed_runs": "runs that failed, by reason",
    "missing_runs": "runs without a usable value",
}
