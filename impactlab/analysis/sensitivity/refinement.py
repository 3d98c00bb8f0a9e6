"""Change of Sobol indices on other grids, from the first base samples solved on each of them.

All grids see the same points of the sample, so that the sampling error of an index nearly cancels
in its change from grid to grid; what is left of it is bootstrapped, the base samples of all grids
drawn together.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.richardson import SAFETY_CREDIBLE, SAFETY_DOUBTFUL, estimate
from impactlab.analysis.responses import usable
from impactlab.analysis.sensitivity import sobol
from impactlab.analysis.sensitivity.indices import Fit, can_impute, imputed
from impactlab.analysis.sensitivity.method import Array, Sample, half_widths
from impactlab.analysis.sensitivity.sobol import Outputs, estimates
from impactlab.analysis.sensitivity.verdict import still, tail

ORDERS = ("first_order", "total_order")
ENDINGS = ("", "_change", "_change_interval")
USED, FINER, COARSER, MORE_POINTS = "used", "finer", "coarser", "more_points"
TAIL_SHARE = 0.25
"""Largest share of the variance that one run in a hundred may carry (normal response: 0.09).

Above, single runs decide, such as those in which a further impact falls into the first contact:
which of them another grid moves, and whether it moves one, so few base samples cannot tell.
"""
_TO_LIMIT = 2.0
"""Distance to the limit over change, where each refinement takes half of the error."""
_FIRST_ORDER = 1.0
ByGrid = Mapping[str, Array]
"""Changes of an index from the used grid, (factor,), or half-widths of these, by grid."""


def uncertainty(refinement: xr.Dataset, fit: Fit) -> xr.Dataset:
    """Return how far the indices of the used grid may lie from those in the limit.

    refinement: see adaptive.refining. fit: makes the surrogate that supplies failed runs where the
    study asks for it.

    Returns for each of ORDERS, on (response, parameter) and without unit: <order>, that distance;
    <order>_change, from the used to the finer grid, and <order>_change_interval, the half-width of
    its interval. NaN where a grid gives no index, and where few runs carry the variance
    (TAIL_SHARE). Raises ValueError when the runs are not the sample that their attributes describe.

    The distance is the change to the finer grid and as much again from there to the limit (first
    order) times SAFETY_DOUBTFUL, or SAFETY_CREDIBLE where the coarser grid, too, shows that the
    changes fall to a half or less; and points.SAFETY times the change with more points (both as for
    responses, see analysis.convergence). Each change is known to within its half-width, and the
    limit is twice as far off.
    """
    sample = Sample.of(refinement)
    sobol.check(sample)
    values = usable(refinement).sortby("run").transpose("response", "grid", "run")
    nodes = refinement["nodes"].values.astype(float)
    spacings = dict(zip(refinement["grid"].values.tolist(), 1.0 / (nodes - 1.0), strict=True))
    names = [str(name) for name in values["response"].values]
    rows = [
        _of_response(name, outputs, spacings, sample, fit)
        for name, outputs in zip(names, values.values, strict=True)
    ]
    gap = np.full(len(sample.factors), np.nan)
    keys = [f"{order}{ending}" for order in ORDERS for ending in ENDINGS]
    return xr.Dataset(
        {key: (("response", "parameter"), [row.get(key, gap) for row in rows]) for key in keys},
        {"response": names, "parameter": list(sample.factors)},
    )


def _of_response(
    name: str, outputs: Array, spacings: Mapping[str, float], sample: Sample, fit: Fit
) -> dict[str, Array]:
    """Analyse one response; empty where a grid gives no index. outputs: (grid, run)."""
    complete = [_complete(row, sample, fit, name) for row in outputs]
    if not all(_measurable(row, sample) for row in complete):
        return {}
    factors, used = len(sample.factors), list(spacings).index(USED)
    statistics = [Outputs.of(row, factors, second_order=False).statistics() for row in complete]

    def changes(means: Array) -> dict[str, Array]:
        parts = [estimates(part, factors) for part in np.split(means, len(spacings), axis=-1)]
        return {
            order: np.stack([part[order] - parts[used][order] for part in parts], axis=-2)
            for order in ORDERS
        }

    columns = np.concatenate(statistics, axis=1)
    found = changes(columns.mean(axis=0))
    widths = half_widths(columns, changes, sample, sample.rng("refinement", name))
    answer: dict[str, Array] = {}
    for order in ORDERS:
        change = dict(zip(spacings, found[order], strict=True))
        width = dict(zip(spacings, widths[f"{order}_interval"], strict=True))
        values = _distance(change, width, spacings), change[FINER], width[FINER]
        answer |= {f"{order}{ending}": value for ending, value in zip(ENDINGS, values, strict=True)}
    return answer


def _distance(change: ByGrid, width: ByGrid, spacings: Mapping[str, float]) -> Array:
    by_spacing = (1.0 + _safety(change, spacings)) * abs(change[FINER])
    by_points = points.SAFETY * abs(change[MORE_POINTS])
    return by_spacing + by_points + _TO_LIMIT * (width[FINER] + width[MORE_POINTS])


def _safety(change: ByGrid, spacings: Mapping[str, float]) -> Array:
    """Return the safety factor on the part beyond the finer grid, (factor,)."""
    if COARSER not in change:
        return np.full_like(change[FINER], SAFETY_DOUBTFUL)
    steps = [spacings[grid] for grid in (FINER, USED, COARSER)]
    triples = [
        estimate(three, steps)
        for three in zip(change[FINER], change[USED], change[COARSER], strict=True)
    ]
    falling = [triple.credible and triple.order >= _FIRST_ORDER for triple in triples]
    return np.where(falling, SAFETY_CREDIBLE, SAFETY_DOUBTFUL)


def _complete(outputs: Array, sample: Sample, fit: Fit, name: str) -> Array:
    """Return outputs with failed runs supplied, if the study asks for it and enough are left."""
    if sample.policy != "impute" or not can_impute(outputs, sample):
        return outputs
    return imputed(outputs, sample, fit, name)


def _measurable(outputs: Array, sample: Sample) -> bool:
    """Return True if every run answered, the response varies, and no few runs dominate it."""
    if not np.isfinite(outputs).all() or still(outputs, sobol.varying(outputs, sample)):
        return False
    return tail(outputs) <= TAIL_SHARE
