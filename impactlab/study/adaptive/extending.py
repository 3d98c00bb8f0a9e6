"""A Sobol sample that is doubled until its intervals are narrow enough.

The sample is nested: the runs of N base samples are the first ones of 2 N, so none is wasted.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.study.sampling.design import doubled

log = logging.getLogger(__name__)
Step = Callable[[xr.Dataset], xr.Dataset]


def extend_sample(design: xr.Dataset, solve: Step, analyse: Step) -> xr.Dataset:
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
    limit, most = float(design.attrs["until_interval"]), int(design.attrs["until_runs"])
    names = np.atleast_1d(design.attrs.get("until_responses", design.attrs["responses"]))
    while True:
        runs = solve(design)
        analysis = analyse(runs.assign_attrs(analyses="sensitivity"))
        found, count = largest_interval(analysis, [str(name) for name in names]), runs.sizes["run"]
        if not found.response:
            reason = "no response has indices that more runs could narrow"
        elif found.half_width <= limit:
            reason = f"{found}, within {limit:g}"
        elif 2 * count > most:
            reason = f"{found}, above {limit:g}, but twice as many runs are more than {most:,}"
        else:
            log.info("%d runs: %s: twice as many", count, found)
            design = doubled(design)
            continue
        log.info("%d runs: %s", count, reason)
        return runs.assign_attrs(
            until_reached=int(found.half_width <= limit),
            until_reason=reason,
            until_widest=found.half_width,
            until_widest_index=found.index,
            until_widest_response=found.response,
            until_widest_parameter=found.parameter,
            until_left_out="\n".join(found.left_out),
        )


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
    verdicts = requested["sensitivity_verdict"]
    lines = str(verdicts.attrs["flag_descriptions"]).splitlines()
    told = dict(zip(np.atleast_1d(verdicts.attrs["flag_values"]), lines, strict=True))
    given_none = zip(np.array(responses)[without], verdicts.values[without], strict=True)
    left_out = tuple(f"{name} ({told[verdict]})" for name, verdict in given_none)
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
