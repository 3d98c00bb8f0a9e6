"""The requested responses of a runs dataset, and a count of what is missing and why."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.variables import FAILED, FAILURES, RESPONSES, status_bits


def listed(runs: xr.Dataset, attribute: str) -> list[str]:
    """Return a list attribute as a list: netCDF gives a list of one back as a plain string."""
    return [str(entry) for entry in np.atleast_1d(runs.attrs[attribute])]


def relevant_bits(name: str) -> int:
    """Return the status bits that make this response missing."""
    return status_bits([name] if name in RESPONSES else [])


def missing(runs: xr.Dataset) -> xr.DataArray:
    """Return True where a run gives no usable number: it is not finite, or its status excludes it.

    Returns bool on (response, *design dims). Raises ValueError when a requested response is not
    among the variables.
    """
    return _missing(runs, _stacked(runs))


def usable(runs: xr.Dataset) -> xr.DataArray:
    """Return the requested responses in SI units, NaN where missing, on (response, *design dims).

    Coordinates response_units and response_long_name describe each one. Raises ValueError
    when a requested response is not among the variables.
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


UNEXPLAINED = ("unexplained", "a response is missing and the run's status does not say why")


def failures(runs: xr.Dataset) -> xr.Dataset:
    """Count the runs: in all, failed, failed by reason, and missing a response.

    Returns number_of_runs, number_of_failed_runs, failed_runs (reason), missing_runs (response).
    A run that failed for two reasons counts under both. `reason` holds the names of the status
    flags and "unexplained"; reason_long_name explains them.
    """
    gaps, status = missing(runs), runs["status"].compute()
    unexplained = _unexplained(gaps, status)
    counts = [int(((status & bit) != 0).sum()) for bit, _ in FAILURES.values()]
    failed = ((status & FAILED) != 0) | unexplained
    rest = [dim for dim in gaps.dims if dim != "response"]
    dataset = xr.Dataset(
        {
            "number_of_runs": ((), status.size, _attrs("runs in the study")),
            "number_of_failed_runs": (
                (),
                int(failed.sum()),
                _attrs("runs that miss a response, or whose status says that they failed"),
            ),
            "failed_runs": (
                "reason",
                [*counts, int(unexplained.sum())],
                _attrs("runs that failed, by reason"),
            ),
            "missing_runs": gaps.sum(rest).assign_attrs(_attrs("runs without a usable value")),
        }
    )
    words = [text for _, text in FAILURES.values()]
    return dataset.assign_coords(
        reason=("reason", [*FAILURES, UNEXPLAINED[0]], {"long_name": "reason of failure"}),
        reason_long_name=("reason", [*words, UNEXPLAINED[1]]),
    )


def _unexplained(gaps: xr.DataArray, status: xr.DataArray) -> xr.DataArray:
    """Return True for runs with a missing response that no bit of their status explains."""
    bits = np.array([relevant_bits(str(name)) for name in gaps["response"].values])
    explained = (status & xr.DataArray(bits, dims="response")) != 0
    return (gaps & ~explained).any("response")


def _attrs(long_name: str) -> dict[str, str]:
    return {"long_name": long_name, "units": "1"}
