"""Saltelli's sample: its points, and Sobol indices as functions of means over base samples.

A sample consists of independent replicates. The indices are functions of means over all base
samples; their intervals are those of the jackknife over the replicates. The outputs at A and at B
have to be uncorrelated, as independent points are: a correlation of theirs enters every first-order
index.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from threading import Lock
from typing import Any, Self

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.methods.runs import Sample, leave_one_out
from impactlab.types import Floats

REPLICATES = 8
"""Independent scrambles of a Sobol sample: fewer widen Student's t, more make each one poorer."""
_ALONE = 5  # columns of the statistics that belong to no factor: a, b, a^2, b^2, a b
_ROWS = 1 << 15  # base samples whose statistics are held at a time


def saltelli(
    groups: Sequence[str],
    base_samples: int,
    second_order: bool,
    seed: int,
    first: int = 0,
    last: int | None = None,
) -> Floats:
    """Draw Saltelli's sample in the unit cube, (runs, parameter), base sample by base sample.

    groups: the group of each parameter; first, last: the base samples to draw, by default all. The
    runs of a base sample are the points A, A with the columns of each group from B, with
    second_order B with the columns of each group from A, and B.

    A and B are the halves of the points of one Sobol sequence, whose dimensions may depend on each
    other four at a time (such as i and j of A and of B), so that the outputs at A and B correlate
    however many points there are. Base sample k is therefore point k // REPLICATES of replicate
    k % REPLICATES: a sequence with a scramble of its own, which makes such a correlation as often
    positive as negative, and an order of its own of the dimensions. The spread of the replicates
    tells the error (L'Ecuyer et al. 2023, Proc. Winter Simulation Conf.), and the first base
    samples are the smaller sample.
    """
    count, dimensions = min(REPLICATES, base_samples), 2 * len(groups)
    last = base_samples if last is None else last
    points = np.empty((last - first, dimensions))
    with _lock:
        for place, (order, sequence) in enumerate(_sequences(dimensions, count, seed)):
            start, stop = (-((place - base) // count) for base in (first, last))
            rows = slice(start * count + place - first, None, count)
            points[rows] = _points(sequence, start, stop)[:, order]
    names = list(dict.fromkeys(groups))
    swapped = np.array([[group == name for group in groups] for name in names])
    every_group = np.ones((1, len(groups)), bool)
    from_b = np.concatenate([~every_group, swapped, *[~swapped] * second_order, every_group])
    a, b = points[:, None, : len(groups)], points[:, None, len(groups) :]
    return np.where(from_b, b, a).reshape(-1, len(groups))


_lock = Lock()


@lru_cache(maxsize=1)  # the next block goes on where one ended
def _sequences(dimensions: int, count: int, seed: int) -> list[tuple[Any, Any]]:
    """Return the order of the dimensions and the scrambled sequence of each replicate."""
    sequences = []
    for stream in np.random.SeedSequence(seed).spawn(count):
        rng = np.random.default_rng(stream)
        order = rng.permutation(dimensions)
        sequences.append((order, scipy.stats.qmc.Sobol(dimensions, rng=rng)))
    return sequences


def _points(sequence: Any, start: int, stop: int) -> Floats:
    """Return points start to stop of a Sobol sequence, (points, dimension)."""
    if start < sequence.num_generated:
        sequence.reset()
    if start > sequence.num_generated:
        sequence.fast_forward(start - sequence.num_generated)
    # a first point by itself: scipy warns of a first block that is no power of two
    alone = min(stop, 1) if start == 0 else 0
    return np.concatenate([sequence.random(alone), sequence.random(stop - start - alone)])


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
    def of(cls, outputs: Floats, sample: Sample) -> Self:
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
