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
            sums = sums + [
                rows[replicate :: self.replicates].sum(axis=0)
                for replicate in range(self.replicates)
            ]
        places = np.arange(len(self.table)) % self.replicates
        sizes = np.bincount(places).astype(float)
        return leave_one_out(sums) / leave_one_out(sizes)[:, None]

    def _statistics(self, interactions: bool, rows: slice) -> Floats:
        """Return the columns whose means the estimators take, (base samples, columns)."""
        table = (self.table[rows] - self.mean) / self.deviation
        columns = statistics(table, self.factors, self.second)
        if not (self.second and interactions):
            return columns
        _, ab, ba, _ = np.split(table, [1, 1 + self.factors, table.shape[1] - 1], axis=1)
        first, second = np.triu_indices(self.factors, 1)
        pairs = (ba[:, first] * ab[:, second] + ba[:, second] * ab[:, first]) / 2
        return np.concatenate([columns, pairs], axis=1)


def statistics(outputs: Floats, factors: int, second: bool) -> Floats:
    """Return the columns whose means give first and total orders, (base samples, column, ...).

    outputs: (base samples, runs of one, ...), in the order of the sample; second: whether runs BA,
    at B with a factor from A, are among them.
    """
    a, ab, ba, b = np.split(outputs, [1, 1 + factors, outputs.shape[1] - 1], axis=1)
    columns = [a, b, a**2, b**2, a * b, ab, ab**2, b * ab, (a - ab) ** 2 / 2]
    if second:
        columns += [ba, ba**2, a * ba, (b - ba) ** 2 / 2]
    return np.concatenate(columns, axis=1)


def step(sample: Sample) -> int:
    """Return the number of runs per base sample."""
    return (2 if sample.number("second_order") else 1) * len(sample.factors) + 2


def ratios(means: Floats, factors: int) -> tuple[Floats, Floats]:
    """Return numerators and denominators of first and total orders, both (..., 2 factors).

    means: of the `statistics`, (..., column). AB and B share the factor alone: their covariance,
    over the mean of their variances, is its first order, and half the mean squared difference of A
    and AB its total order (Janon et al. 2014, eq. 6; Jansen 1999). BA, where it is given, makes a
    second pair of each. The covariance of A and B, 0 for an endless sample, is a control variate:
    the errors of that of AB and B follow it as far as AB follows A, by 1 less the total order. Of
    a parameter that the model never sees, AB = A, and both are zero to the last digit.
    """
    a, b, squared_a, squared_b, product = np.moveaxis(means[..., :_ALONE], -1, 0)
    halves = means[..., _ALONE:].reshape(*means.shape[:-1], -1, 4, factors)
    mean, square, shared, apart = np.moveaxis(halves, -2, 0)  # (..., half, factor) each
    count = mean.shape[-2]
    partner = np.stack([b, a], axis=-1)[..., :count, None]
    variances = np.stack([squared_b - b**2, squared_a - a**2], axis=-1)
    scatter = square - mean**2
    with_same = (variances[..., :count, None] + scatter).sum(axis=-2) / 2
    with_others = (variances[..., ::-1][..., :count, None] + scatter).sum(axis=-2) / 2
    total = apart.sum(axis=-2)
    weight = np.clip(1 - total / _positive(with_others), 0, 1)
    control = count * (product - a * b)[..., None]
    first = (shared - partner * mean).sum(axis=-2) - weight * control
    return np.concatenate([first, total], axis=-1), np.concatenate([with_same, with_others], -1)


def estimates(means: Floats, factors: int) -> dict[str, Floats]:
    """Return indices from the means of all columns, (..., column); NaN where nothing varies.

    first_order, total_order (..., factor): see `ratios`; second_order (..., pair): the covariance
    of BA and AB, which share two factors, by the same rule, less both first orders;
    base_correlation (...): of A and B.
    """
    halves = 2 if means.shape[-1] > _ALONE + 4 * factors else 1
    columns, pairs = np.split(means, [_ALONE + 4 * halves * factors], axis=-1)
    numerators, denominators = ratios(columns, factors)
    first, total = np.split(numerators / _positive(denominators), 2, axis=-1)
    a, b, squared_a, squared_b, product = np.moveaxis(means[..., :_ALONE], -1, 0)
    covariance, variance = product - a * b, (squared_a + squared_b - a**2 - b**2) / 2
    indices = {
        "first_order": first,
        "total_order": total,
        "base_correlation": covariance / _positive(variance),
    }
    if pairs.shape[-1]:
        i, j = np.triu_indices(factors, 1)
        halved = columns[..., _ALONE:].reshape(*means.shape[:-1], 2, 4, factors)
        ab, ba = np.moveaxis(halved[..., 0, :], -2, 0)
        scatter = (halved[..., 1, :] - halved[..., 0, :] ** 2).sum(axis=-2)
        weight = np.clip(1 - total[..., i] - total[..., j], 0, 1)
        closed = pairs - (ab[..., i] * ba[..., j] + ab[..., j] * ba[..., i]) / 2
        closed = closed - weight * covariance[..., None]
        closed = closed / _positive((scatter[..., i] + scatter[..., j]) / 4)
        indices["second_order"] = closed - first[..., i] - first[..., j]
    return indices


def _positive(variance: Floats) -> Floats:
    return np.where(variance > np.finfo(float).eps, variance, np.nan)


HALVINGS = 5  # number of halvings of the sample that show how its indices settle: from N/32 on
FEWEST = 8  # base samples below which halves are not shown
CHANCE = 0.001  # of independent base samples whose correlation exceeds its noise
JANON = (
    "Janon et al. (2014), ESAIM Probab. Stat. 18, 342, eq. 6, with the covariance of both base "
    "samples as control variate"
)
JANSEN = "Jansen (1999), Comput. Phys. Commun. 117, 35, with the variance of the same runs"
_NESTED = "from the first base samples alone, which are a smaller sample of the same kind"
_INDICES = {
    "first_order": Index("first-order Sobol index", JANON),
    "total_order": Index("total-order Sobol index", JANSEN),
    "second_order": Index("second-order Sobol index", JANON, PAIR),
    "first_order_by_samples": Index(
        "first-order Sobol index by base samples", JANON, BY_SAMPLES, comment=_NESTED
    ),
    "total_order_by_samples": Index(
        "total-order Sobol index by base samples", JANSEN, BY_SAMPLES, comment=_NESTED
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
    size = f"{base} base samples of {factors} {'groups' if sample.groups else 'parameters'}"
    sample.expect(base * step(sample), size)


def base_samples(sample: Sample) -> list[int]:
    """Return the sizes of the nested samples, up to the whole one."""
    largest = sample.number("base_samples")
    sizes = [largest >> halving for halving in range(HALVINGS, 0, -1)]
    return [size for size in sizes if size >= FEWEST] + [largest]


def varying(outputs: Floats, sample: Sample) -> list[Floats]:
    """Return the outputs that have to vary: the variance comes from the two base samples."""
    size = step(sample)
    return [np.concatenate([outputs[::size], outputs[size - 1 :: size]])]


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    series = [_of_first(size, outputs, sample) for size in base_samples(sample)]
    indices, gap = dict(series[-1]), np.full(len(sample.factors), np.nan)
    for order in ("first_order", "total_order"):
        for ending in ("", "_interval"):
            values = [part.get(f"{order}{ending}", gap) for part in series]
            indices[f"{order}_by_samples{ending}"] = np.stack(values)
    return indices


def _of_first(size: int, outputs: Floats, sample: Sample) -> dict[str, Floats]:
    """Return the indices on the first base samples; none where these do not vary."""
    start, factors = outputs[: size * step(sample)], len(sample.factors)
    if still(start, varying(start, sample)):
        return {}
    interactions = start.size == outputs.size  # pairs have no indices by samples
    replicated = estimates(Outputs.of(start, sample).means(interactions), factors)
    indices = {name: values[0] for name, values in replicated.items()}
    for name in replicated.keys() - {"base_correlation"}:
        indices[f"{name}_interval"] = half_width(replicated[name][1:], sample.confidence)
    indices["base_correlation_noise"] = half_width(replicated["base_correlation"][1:], 1 - CHANCE)
    for name in {"second_order", "second_order_interval"} & indices.keys():
        indices[name] = _matrix(indices[name], factors)
    return indices


def _matrix(values: Floats, factors: int) -> Floats:
    """Return values of pairs as a symmetric matrix, NaN on its diagonal."""
    matrix = np.full((factors, factors), np.nan)
    matrix[np.triu_indices(factors, 1)] = values
    return np.where(np.isnan(matrix), matrix.T, matrix)


METHOD = Method("sobol", _INDICES, check, _estimate, varying)
