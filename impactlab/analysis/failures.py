"""Which runs failed and why: counted for every study, so that no gap stays silent."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.responses import missing, relevant_bits
from impactlab.variables import FAILED, FAILURES

UNEXPLAINED = ("unexplained", "a response is missing and the run's status does not say why")


def applies(runs: xr.Dataset) -> bool:
    """Always: a study without failures says so too."""
    return True


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Counts of runs: in all, failed, failed by reason, and missing a response.

    Returns number_of_runs, number_of_failed_runs, failed_runs (reason), missing_runs (response).
    A run that failed for two reasons counts under both. `reason` holds the names of the status
    flags and "unexplained"; reason_long_name says them in words.
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
    """True for runs with a missing response that no bit of their status explains."""
    bits = np.array([relevant_bits(str(name)) for name in gaps["response"].values])
    explained = (status & xr.DataArray(bits, dims="response")) != 0
    return (gaps & ~explained).any("response")


def _attrs(long_name: str) -> dict[str, str]:
    return {"long_name": long_name, "units": "1"}
