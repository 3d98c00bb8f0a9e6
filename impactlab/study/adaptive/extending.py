"""A Sobol sample that is doubled until its intervals are narrow enough.

The sample is nested: the runs of N base samples are the first ones of 2 N, so none is wasted.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import Any

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
        half_width, index = found["until_widest"], found["until_widest_index"].replace("_", "-")
        response, parameter = found["until_widest_response"], found["until_widest_parameter"]
        widest = f"the widest interval is that of the {index} index of {response} to {parameter}"
        if not response:
            reason = "no response has indices that more runs could narrow"
        elif half_width <= limit:
            reason = f"{widest}, ± {half_width:.3g}, within {limit:g}"
        elif 2 * count > most:
            more = f"but twice as many runs are more than {most:,}"
            reason = f"{widest}, ± {half_width:.3g}, above {limit:g}, {more}"
        else:
            log.info("%d runs: %s, ± %.3g: twice as many", count, widest, half_width)
            design = doubled(design)
            continue
        log.info("%d runs: %s", count, reason)
        reached = int(half_width <= limit)
        return runs.assign_attrs(until_reached=reached, until_reason=reason, **found)


def largest_interval(analysis: xr.Dataset, responses: Sequence[str]) -> dict[str, Any]:
    """Return the largest interval of the first and total-order indices of these responses.

    analysis: <index>_interval on (response, parameter), NaN for a response without indices, and
    sensitivity_verdict (response) with the reason. It is returned as the attributes until_widest,
    until_widest_index, until_widest_response, until_widest_parameter and until_left_out (see
    extend_sample): NaN and empty where no response has indices.
    """
    requested = analysis.sel(response=list(responses))
    intervals = requested[["first_order_interval", "total_order_interval"]].to_array("index")
    missing = intervals.isnull().all(["index", "parameter"]).values
    verdicts = requested["sensitivity_verdict"]
    lines = str(verdicts.attrs["flag_descriptions"]).splitlines()
    told = dict(zip(np.atleast_1d(verdicts.attrs["flag_values"]), lines, strict=True))
    without = zip(np.array(responses)[missing], verdicts.values[missing], strict=True)
    left_out = "\n".join(f"{name} ({told[verdict]})" for name, verdict in without)
    half_width, index, response, parameter = np.nan, "", "", ""
    if not missing.all():
        given = intervals.isel(response=~missing).fillna(np.inf)
        widest = given.isel(given.argmax(["index", "response", "parameter"]))
        half_width, index = widest.item(), widest["index"].item().removesuffix("_interval")
        response, parameter = widest["response"].item(), widest["parameter"].item()
    return {
        "until_widest": half_width,
        "until_widest_index": index,
        "until_widest_response": response,
        "until_widest_parameter": parameter,
        "until_left_out": left_out,
    }
