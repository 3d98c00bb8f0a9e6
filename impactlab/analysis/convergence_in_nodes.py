"""Convergence with the nodes along the span: order, Richardson value, GCI and a verdict."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from impactlab.analysis.responses import usable
from impactlab.analysis.richardson import (
    CREDIBLE_ORDERS,
    SAFETY_CREDIBLE,
    SAFETY_DOUBTFUL,
    Behaviour,
    Estimate,
    estimate,
)
from impactlab.analysis.verdicts import TOLERANCE, Verdict, verdict_variables

COMMENT = (
    "From the three finest grids, spacing = span/(nodes - 1). The time step follows the scheme's "
    "largest, hence the square of the spacing with leapfrog, the spacing with the semi-implicit "
    "scheme: the order is that of space and time together."
)

VANISHING = 0.1
"""Richardson value over finest value up to which a shrinking response is on its way to zero."""


class NodesVerdict(Verdict):
    """What refinement along the span shows for one response at one point of the grid."""

    AT_ROUND_OFF = 0, True, "the three finest grids agree to 1e-9: nothing left to converge"
    CONVERGED_SECOND_ORDER = (
        1,
        True,
        "monotone, order 2 within 0.5, credible on every three successive grids, GCI within 1 %",
    )
    CONVERGED = 2, True, "monotone, credible order (0.5 to 3), GCI within 1 %"
    SETTLED = (
        3,
        True,
        "no credible order, but no drift either: three times the range of the three finest "
        "values is within 1 % (Eca and Hoekstra's bound for scattered data)",
    )
    TENDS_TO_ZERO = 4, False, "converges to zero: a relative error has no meaning"
    NOT_YET_CONVERGED = 5, False, "convergence too slow or too far off to bound the error by 1 %"
    OSCILLATORY = 6, False, "the differences shrink but change sign: no Richardson value"
    UNDETERMINED = 7, False, "a run on the three finest grids is missing: no number is given"
    DIVERGENT = 8, False, "the differences do not shrink as the grid is refined"


class Judgement(NamedTuple):
    """Numbers and verdict on one response; NaN where undefined."""

    observed_order: float
    extrapolated: float
    gci: float
    safety_factor: float
    verdict: NodesVerdict


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a grid with three or more values of `nodes`."""
    return runs.sizes.get("nodes", 0) >= 3


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Nodes convergence of every response at every point of the rest of the grid.

    Returns on (response, *other grid dims): nodes_observed_order, nodes_extrapolated (where the
    order is credible, in the unit of the response), nodes_gci (relative, finest grid),
    nodes_safety_factor and nodes_verdict; beside them nodes_summary (response) and nodes_tally
    (response, nodes_outcome). Raises ValueError for a repeated number of nodes.
    """
    values = usable(runs).sortby("nodes", ascending=False)
    spacings = 1.0 / (values["nodes"].values - 1.0)
    fields = xr.apply_ufunc(
        partial(judge, spacings=spacings),
        values,
        input_core_dims=[["nodes"]],
        output_core_dims=[[]] * len(Judgement._fields),
        output_dtypes=[float] * 4 + [np.int8],
        vectorize=True,
    )
    found = dict(zip(Judgement._fields, fields, strict=True))
    numbers = {f"nodes_{key}": found[key].assign_attrs(attrs) for key, attrs in _ATTRS.items()}
    verdicts = verdict_variables(
        found["verdict"], NodesVerdict, "nodes", "convergence with the nodes"
    )
    dataset = xr.Dataset(numbers | verdicts)
    for name in ("nodes_verdict", "nodes_summary"):
        dataset[name].attrs |= {"tolerance": TOLERANCE, "comment": COMMENT}
    return dataset


def judge(values: npt.NDArray[np.float64], spacings: npt.NDArray[np.float64]) -> Judgement:
    """Order, Richardson value, GCI and verdict of one response on three or more grids.

    values: in any unit, spacings: in any unit, both (grids,) and finest first. The three finest
    give the numbers; the safety factor is 1.25 where every three successive grids show a
    credible order and 3 otherwise. Raises ValueError unless the spacings rise.
    """
    triples = [estimate(values[i : i + 3], spacings[i : i + 3]) for i in range(len(values) - 2)]
    finest = triples[0]
    credible = all(triple.credible for triple in triples)
    safety = SAFETY_CREDIBLE if credible else SAFETY_DOUBTFUL
    gci = finest.gci(safety)
    return Judgement(
        finest.order,
        finest.extrapolated if finest.credible else np.nan,
        gci,
        np.nan if np.isnan(gci) else safety,
        _verdict(finest, values[:3], safety, credible),
    )


def _verdict(
    finest: Estimate, values: npt.NDArray[np.float64], safety: float, credible: bool
) -> NodesVerdict:
    if finest.credible and finest.gci(safety) <= TOLERANCE:
        second = credible and finest.asymptotic
        return NodesVerdict.CONVERGED_SECOND_ORDER if second else NodesVerdict.CONVERGED
    if _free_of_drift(finest) and SAFETY_DOUBTFUL * np.ptp(values) <= TOLERANCE * abs(values[0]):
        return NodesVerdict.SETTLED
    if finest.credible and _tends_to_zero(finest, values):
        return NodesVerdict.TENDS_TO_ZERO
    return _OTHERWISE[finest.behaviour]


def _free_of_drift(finest: Estimate) -> bool:
    """Whether the range of the values bounds the error: not for a slow or growing drift."""
    if finest.behaviour is Behaviour.MONOTONE:
        return finest.order > max(CREDIBLE_ORDERS)
    return finest.behaviour in (
        Behaviour.OSCILLATORY,
        Behaviour.OSCILLATORY_DIVERGENT,
        Behaviour.STALLED,
    )


def _tends_to_zero(finest: Estimate, values: npt.NDArray[np.float64]) -> bool:
    shrinking = abs(values[0]) < abs(values[1]) < abs(values[2])
    return bool(shrinking and abs(finest.extrapolated) <= VANISHING * abs(finest.fine))


_OTHERWISE = {
    Behaviour.CONSTANT: NodesVerdict.AT_ROUND_OFF,
    Behaviour.MONOTONE: NodesVerdict.NOT_YET_CONVERGED,
    Behaviour.STALLED: NodesVerdict.NOT_YET_CONVERGED,
    Behaviour.OSCILLATORY: NodesVerdict.OSCILLATORY,
    Behaviour.MONOTONE_DIVERGENT: NodesVerdict.DIVERGENT,
    Behaviour.OSCILLATORY_DIVERGENT: NodesVerdict.DIVERGENT,
    Behaviour.UNDETERMINED: NodesVerdict.UNDETERMINED,
}
"""Verdicts where no number bounds the error."""

_ATTRS = {
    "observed_order": {
        "long_name": "observed order of convergence with the nodes",
        "units": "1",
        "comment": COMMENT,
    },
    "extrapolated": {
        "long_name": "Richardson value at zero spacing",
        "comment": "In the unit of response_units; given where the order is credible. " + COMMENT,
    },
    "gci": {
        "long_name": "grid convergence index of the finest grid",
        "units": "1",
        "comment": "Relative to the finest value, infinite where that is zero. " + COMMENT,
    },
    "safety_factor": {"long_name": "safety factor in the grid convergence index", "units": "1"},
}
