"""The widest interval among the indices of a sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

_INDICES = ("first_order", "total_order")


@dataclass(frozen=True)
class Widest:
    """Half-width of the widest interval, and of which index it is.

    NaN and empty names where no response has indices. left_out: the responses without, each with
    the reason.
    """

    half_width: float
    index: str
    response: str
    parameter: str
    left_out: tuple[str, ...]

    def __str__(self) -> str:
        """In words."""
        if not self.response:
            return "no interval"
        return (
            f"the widest interval is that of the {self.index.replace('_', '-')} index of "
            f"{self.response} to {self.parameter}, ± {self.half_width:.3g}"
        )


def widest(analysis: xr.Dataset, responses: Sequence[str]) -> Widest:
    """Of the first and total-order indices of these responses.

    analysis: <index>_interval on (response, parameter), without any number for a response that
    is given no index, and sensitivity_verdict (response), which says why.
    """
    asked = analysis.sel(response=list(responses))
    found = asked[[f"{name}_interval" for name in _INDICES]].to_array("index")
    found = found.transpose("index", "response", "parameter")
    without = np.isnan(found.values).all(axis=(0, 2))
    left_out = tuple(_reason(asked, name) for name in np.array(responses)[without])
    if without.all():
        return Widest(np.nan, "", "", "", left_out)
    given = found.isel(response=~without).fillna(np.inf)
    index, response, parameter = np.unravel_index(given.values.argmax(), given.shape)
    return Widest(
        float(given.values[index, response, parameter]),
        _INDICES[index],
        str(given["response"].values[response]),
        str(given["parameter"].values[parameter]),
        left_out,
    )


def _reason(analysis: xr.Dataset, response: str) -> str:
    """The response with its verdict's description ("name: words") from the flags."""
    verdicts = analysis["sensitivity_verdict"]
    lines = str(verdicts.attrs["flag_descriptions"]).splitlines()
    described = dict(zip(np.atleast_1d(verdicts.attrs["flag_values"]), lines, strict=True))
    return f"{response} ({described[verdicts.sel(response=response).item()]})"
