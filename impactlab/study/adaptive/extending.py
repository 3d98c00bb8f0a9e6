"""A Sobol sample that is doubled until its intervals are narrow enough.

The sample is nested: the runs of N base samples are the first ones of 2 N, so none is wasted.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.sampling.doubling import doubled

log = logging.getLogger(__name__)
Step = Callable[[xr.Dataset], xr.Dataset]


def extended(design: xr.Dataset, solve: Step, analyse: Step) -> xr.Dataset:
    """Return the runs of the smallest sample whose intervals are as narrow as requested.

    design: of a Sobol study with `until`. solve: returns the runs of a design; analyse: returns
    first_order_interval, total_order_interval (response, parameter) and sensitivity_verdict
    (response) of runs.

    Attributes of the runs are until_reached (1: the intervals are narrow enough), until_reason (why
    it stopped, in words), until_widest (the largest half-width) and its index, response and
    parameter, until_widest_index, until_widest_response and until_widest_parameter, and
    until_left_out: one line per response without indices, with the reason. Raises ValueError when
    this version of impactlab draws other runs than the design has.
    """
    while True:
        runs = solve(design)
        analysis = analyse(runs.assign_attrs(analyses="sensitivity"))
        found = largest_interval(analysis, _requested(design))
        reason = _reason_to_stop(design, found)
        log.info("%d runs: %s", runs.sizes["run"], reason or f"{found}: twice as many")
        if reason:
            return runs.assign_attrs(_attributes(design, found, reason))
        design = doubled(design)


def _requested(design: xr.Dataset) -> list[str]:
    names = design.attrs.get("until_responses", design.attrs["responses"])
    return [str(name) for name in np.atleast_1d(names)]


def _reason_to_stop(design: xr.Dataset, found: LargestInterval) -> str:
    """Return why to stop; "" where the sample is to be doubled."""
    interval, most = float(design.attrs["until_interval"]), int(design.attrs["until_runs"])
    if not found.response:
        return "no response has indices that more runs could narrow"
    if found.half_width <= interval:
        return f"{found}, within {interval:g}"
    if 2 * design.sizes["run"] > most:
        return f"{found}, above {interval:g}, but twice as many runs are more than {most:,}"
    return ""


def _attributes(design: xr.Dataset, found: LargestInterval, reason: str) -> dict[str, Any]:
    return {
        "until_reached": int(found.half_width <= float(design.attrs["until_interval"])),
        "until_reason": reason,
        "until_widest": found.half_width,
        "until_widest_index": found.index,
        "until_widest_response": found.response,
        "until_widest_parameter": found.parameter,
        "until_left_out": "\n".join(found.left_out),
    }


_INDICES = ("first_order", "total_order")


@dataclass(frozen=True)
class LargestInterval:
    """The half-width of the largest interval, and its index, response and parameter.

    They are NaN and empty where no response has indices. left_out: the responses without, each with
    the reason.
    """

    half_width: float
    index: str
    response: str
    parameter: str
    left_out: tuple[str, ...]

    def __str__(self) -> str:
        """Return the interval in words."""
        if not self.response:
            return "no interval"
        return (
            f"the widest interval is that of the {self.index.replace('_', '-')} index of "
            f"{self.response} to {self.parameter}, ± {self.half_width:.3g}"
        )


def largest_interval(analysis: xr.Dataset, responses: Sequence[str]) -> LargestInterval:
    """Return the largest interval of the first and total-order indices of these responses.

    analysis: <index>_interval on (response, parameter), NaN for a response without indices, and
    sensitivity_verdict (response) with the reason.
    """
    requested = analysis.sel(response=list(responses))
    found = requested[[f"{name}_interval" for name in _INDICES]].to_array("index")
    found = found.transpose("index", "response", "parameter")
    without = np.isnan(found.values).all(axis=(0, 2))
    left_out = tuple(_verdict(requested, name) for name in np.array(responses)[without])
    if without.all():
        return LargestInterval(np.nan, "", "", "", left_out)
    given = found.isel(response=~without).fillna(np.inf)
    index, response, parameter = np.unravel_index(given.values.argmax(), given.shape)
    return LargestInterval(
        float(given.values[index, response, parameter]),
        _INDICES[index],
        str(given["response"].values[response]),
        str(given["parameter"].values[parameter]),
        left_out,
    )


def _verdict(analysis: xr.Dataset, response: str) -> str:
    """Return the response with its verdict's description ("name: words") from the flags."""
    verdicts = analysis["sensitivity_verdict"]
    lines = str(verdicts.attrs["flag_descriptions"]).splitlines()
    described = dict(zip(np.atleast_1d(verdicts.attrs["flag_values"]), lines, strict=True))
    return f"{response} ({described[verdicts.sel(response=response).item()]})"
