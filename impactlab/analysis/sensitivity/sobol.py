"""Sobol indices from a Saltelli sample, with intervals from its replicates.

A sample consists of independent replicates (see study.sampling.samples.saltelli). The indices are
functions of means over all base samples; their intervals are those of the jackknife over the
replicates. The outputs at A and at B have to be uncorrelated, as independent points are: a
correlation of theirs enters every first-order index.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import (
    BY_SAMPLES,
    PAIR,
    Index,
    Method,
    half_width,
    leave_one_out,
)
from impactlab.analysis.sensitivity.verdict import still
from impactlab.types import Floats

_ALONE = 5  # columns of the statistics that belong to no factor: a, b, a^2, b^2, a b
_ROWS = 1 << 15  # base samples whose statistics are held at a time


@dataclass(frozen=True)
class Outputs:
    """Outputs of one response at the points of a Saltelli sample, standardised as a whole.

    They are standardised when they are used: memory holds the outputs as they are, once.

    table: (base samples, runs of one), in the order of the sample. second: whether with second
    order. replicates: number of replicates; base sample k belongs to replicate k % replicates.
    """

    table: Floats
    mean: float
    deviation: float
    factors: int
    second: bool
    replicates: int

    @classmethod
    def of(cls, outputs: Floats, sample: Sample) -> Outputs:
        """Return outputs (runs,), which are not all equal, as a table."""
        table, second = outputs.reshape(-1, step(sample)), bool(sample.number("second_order"))
        replicates = min(sample.number("replicates"), len(table))
        factors = len(sample.factors)
        return cls(table, outputs.mean(), outputs.std(), factors, second, replicates)

    def means(self, interactions: bool = True) -> Floats:
        """Return means of the statistics, (1 + replicates, column): of all, then without each."""
        sums = np.zeros(())
        for start in range(0, len(self.table), _ROWS):
            rows = self._statistics(interactions, slice(start, start + _ROWS))
            sums = sums + [rows[at :: self.replicates].sum(axis=0) for at in range(self.replicates)]
        places = np.arange(len(self.table)) % self.replicates
        sizes = np.bincount(places).astype(float)
        return leave_one_out(sums) / leave_one_out(sizes)[:, None]

    def _statistics(self, interactions: bool, rows: slice) -> Floats:
        """Return the columns whose means the estimators take, (base samples, columns)."""
        table = (self.table[rows] - self.mean) / self.deviation
        a, ab, ba, b = np.split(table, [1, 1 + self.factors, table.shape[1] - 1], axis=1)
        columns = [a, b, a**2, b**2, a * b, ab, ab**2, b * ab, (a - ab) ** 2 / 2]
        if self.second:
            columns += [ba, ba**2, a * ba, (b - ba) ** 2 / 2]
        if self.second and interactions:
            first, second = np.triu_indices(self.factors, 1)
            columns.append((ba[:, first] * ab[:, second] + ba[:, second] * ab[:, first]) / 2)
        return np.concatenate(columns, axis=1)


def step(sample: Sample) -> int:
    """Return the number of runs per base sample."""
    return (2 if sample.number("second_order") else 1) * len(sample.factors) + 2


def estimates(means: Floats, factors: int) -> dict[str, Floats]:
    """Return indices from the means of the statistics, (..., columns); NaN where nothing varies.

    first_order, total_order (..., factor); second_order (..., pair); base_correlation (...).

    AB and B share the factor alone: their covariance, over the mean of their variances, is the
    first-order index; likewise that of A and AB is the total order of the other factors (Janon et
    al. 2014, eq. 6), and with second order BA and A, and B and BA, give a second estimate each.
    The covariance of A and B, 0 for an endless sample, is a control variate: the errors of the
    covariance of AB and B follow it as far as AB follows A, by 1 less the total order. So is it
    for BA and AB, which share two factors, by 1 less the total orders of both. Of a parameter that
    the model never sees, AB = A, and all indices are zero to the last digit.
    """
    a, b, squared_a, squared_b, product = np.moveaxis(means[..., :_ALONE], -1, 0)
    base, variances = product - a * b, np.stack([squared_b - b**2, squared_a - a**2], axis=-1)
    count = 1 if means.shape[-1] == _ALONE + 4 * factors else 2
    halves, pairs = np.split(means[..., _ALONE:], [4 * count * factors], axis=-1)
    halves = halves.reshape(*means.shape[:-1], count, 4, factors)
    mean, square, shared, apart = np.moveaxis(halves, -2, 0)  # (..., half, factor) each
    scatter = square - mean**2
    with_same = (variances[..., :count, None] + scatter).sum(axis=-2) / 2
    with_others = (variances[..., ::-1][..., :count, None] + scatter).sum(axis=-2) / 2
    total = apart.sum(axis=-2) / _positive(with_others)
    covariance = (shared - np.stack([b, a], axis=-1)[..., :count, None] * mean).sum(axis=-2)
    control = count * base[..., None]
    first = (covariance - np.clip(1 - total, 0, 1) * control) / _positive(with_same)
    found = {
        "first_order": first,
        "total_order": total,
        "base_correlation": base / _positive(variances.mean(axis=-1)),
    }
    if pairs.shape[-1]:
        i, j = np.triu_indices(factors, 1)
        means_of_pairs = (mean[..., 0, i] * mean[..., 1, j] + mean[..., 0, j] * mean[..., 1, i]) / 2
        weight = np.clip(1 - total[..., i] - total[..., j], 0, 1)
        closed = pairs - means_of_pairs - weight * base[..., None]
        scatters = scatter.sum(axis=-2)
        closed = closed / _positive((scatters[..., i] + scatters[..., j]) / 4)
        found["second_order"] = closed - first[..., i] - first[..., j]
    return found


def _positive(variance: Floats) -> Floats:
    return np.where(variance > np.finfo(float).eps, variance, np.nan)


HALVINGS = 5  # number of halvings of the sample that show how its indices settle: from N/32 on
FEWEST = 8  # base samples below which halves are not shown
CHANCE = 0.001  # of independent base samples whose correlation exceeds its noise
_2014 = (
    "Janon et al. (2014), ESAIM Probab. Stat. 18, 342, eq. 6, with the covariance of both base "
    "samples as control variate"
)
_1999 = "Jansen (1999), Comput. Phys. Commun. 117, 35, with the variance of the same runs"
_NESTED = "from the first base samples alone, which are a smaller sample of the same kind"
_INDICES = {
    "first_order": Index("first-order Sobol index", _2014),
    "total_order": Index("total-order Sobol index", _1999),
    "second_order": Index("second-order Sobol index", _2014, PAIR),
    "first_order_by_samples": Index(
        "first-order Sobol index by base samples", _2014, BY_SAMPLES, comment=_NESTED
    ),
    "total_order_by_samples": Index(
        "total-order Sobol index by base samples", _1999, BY_SAMPLES, comment=_NESTED
    ),
    "base_correlation": Index(
        "correlation of the response between the two base samples, A and B",
        "Pearson, with the mean and the variance of both",
        (),
        interval=False,
        comment="it enters every first-order index, and is 0 for independent base samples",
    ),
    "base_correlation_noise": Index(
        f"magnitude that the correlation exceeds by chance in {CHANCE:.1%} of samples",
        "jackknife over the replicates, with Student's t",
        (),
        interval=False,
    ),
}


def check(sample: Sample) -> None:
    """Raise ValueError where the sample has no replicates, or another number of runs."""
    if "replicates" not in sample.settings:
        raise ValueError(
            f"{sample.study} has a sample of an earlier version of impactlab, whose first-order "
            "indices may be wrong by more than their intervals: draw it again with `impactlab "
            "design`, then solve it"
        )
    base, factors = sample.number("base_samples"), len(sample.factors)
    words = f"{base} base samples of {factors} {'groups' if sample.groups else 'parameters'}"
    sample.expect(base * step(sample), words)


def base_samples(sample: Sample) -> list[int]:
    """Return the sizes of the nested samples, up to the whole one."""
    whole = sample.number("base_samples")
    sizes = [whole >> halving for halving in range(HALVINGS, 0, -1)]
    return [size for size in sizes if size >= FEWEST] + [whole]


def varying(outputs: Floats, sample: Sample) -> list[Floats]:
    """Return the outputs that have to vary: the variance comes from the two base samples."""
    size = step(sample)
    return [np.concatenate([outputs[::size], outputs[size - 1 :: size]])]


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    series = [_of_first(size, outputs, sample) for size in base_samples(sample)]
    found, gap = dict(series[-1]), np.full(len(sample.factors), np.nan)
    for order in ("first_order", "total_order"):
        for ending in ("", "_interval"):
            values = [part.get(f"{order}{ending}", gap) for part in series]
            found[f"{order}_by_samples{ending}"] = np.stack(values)
    return found


def _of_first(size: int, outputs: Floats, sample: Sample) -> dict[str, Floats]:
    """Return the indices on the first base samples; none where these do not vary."""
    start, factors = outputs[: size * step(sample)], len(sample.factors)
    if still(start, varying(start, sample)):
        return {}
    interactions = start.size == outputs.size  # pairs have no indices by samples
    replicated = estimates(Outputs.of(start, sample).means(interactions), factors)
    found = {name: values[0] for name, values in replicated.items()}
    for name in replicated.keys() - {"base_correlation"}:
        found[f"{name}_interval"] = half_width(replicated[name][1:], sample.confidence)
    found["base_correlation_noise"] = half_width(replicated["base_correlation"][1:], 1 - CHANCE)
    for name in {"second_order", "second_order_interval"} & found.keys():
        found[name] = _matrix(found[name], factors)
    return found


def _matrix(values: Floats, factors: int) -> Floats:
    """Return values of pairs as a symmetric matrix, NaN on its diagonal."""
    matrix = np.full((factors, factors), np.nan)
    matrix[np.triu_indices(factors, 1)] = values
    return np.where(np.isnan(matrix), matrix.T, matrix)


METHOD = Method("sobol", _INDICES, check, _estimate, varying)
