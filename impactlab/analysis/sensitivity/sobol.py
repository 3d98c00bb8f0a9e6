"""Sobol indices with bootstrap intervals, from a Saltelli sample, by SALib's estimators.

SALib answers a NaN or a constant output with indices of zero, takes seed 0 for no seed, and needs a
minute per output for its intervals. It gets complete and varying outputs alone, and gives the
indices; the intervals are those of its bootstrap, from the same estimators as functions of means
over the base samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from SALib.analyze import sobol

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import BY_SAMPLES, PAIR, Index, Method, half_widths
from impactlab.analysis.sensitivity.verdict import still
from impactlab.types import Floats

_ALONE = 4  # columns of the statistics that belong to no factor: a, b, a^2, b^2


ALL = slice(None)
MOST_ROWS = 1 << 18  # base samples that are resampled as they are; more are resampled in groups


@dataclass(frozen=True)
class Outputs:
    """Outputs of one response at the points of a Saltelli sample, standardised as a whole.

    They are standardised when they are used: memory holds the outputs as they are, once.

    table: (base samples, runs of one), in SALib's order. second: whether with second order.
    """

    table: Floats
    mean: float
    deviation: float
    factors: int
    second: bool

    @classmethod
    def of(cls, outputs: Floats, sample: Sample) -> Outputs:
        """Return outputs (runs,), which are not all equal, as a table."""
        table, second = outputs.reshape(-1, step(sample)), bool(sample.number("second_order"))
        return cls(table, outputs.mean(), outputs.std(), len(sample.factors), second)

    def at(self, *columns: int | slice, rows: slice = ALL) -> list[Floats]:
        """Return columns of the table, standardised.

        At A (the first) and B (the last); behind A at A with a factor's columns from B, then at B
        with columns from A.
        """
        return [(self.table[rows, each] - self.mean) / self.deviation for each in columns]

    def statistics(self, interactions: bool = True, rows: slice = ALL) -> Floats:
        """Return the columns whose means the estimators take, (base samples, columns)."""
        end = 1 + self.factors
        a, ab, b = self.at(slice(0, 1), slice(1, end), slice(-1, None), rows=rows)
        columns = [a, b, a**2, b**2, b * (ab - a), (a - ab) ** 2 / 2]
        if self.second and interactions:
            first, second = np.triu_indices(self.factors, 1)
            (ba,) = self.at(slice(end, -1), rows=rows)
            columns.append(ba[:, first] * ab[:, second] - a * b)
        return np.concatenate(columns, axis=1)

    def resampled(self, interactions: bool, rng: np.random.Generator) -> Floats:
        """Return the rows to resample, (rows, columns): the statistics, or the means of groups.

        More than MOST_ROWS base samples are drawn into groups of equal size, block by block. Of the
        mean of all, the means of groups tell the variance as the rows do: to a share of
        sqrt(2 / groups), which is beside that of the resamples. (Drawn, for neighbours in a
        low-discrepancy sequence are no independent draws.) The fewer base samples than one group
        has that are left over are not resampled.
        """
        size = -(-len(self.table) // MOST_ROWS)
        groups = len(self.table) // size
        if size == 1:
            return self.statistics(interactions)
        starts = range(0, groups * size, groups)
        blocks = (self.statistics(interactions, slice(at, at + groups)) for at in starts)
        total = next(blocks)
        for block in blocks:
            total += block[rng.permutation(groups)]
        return total / size


def step(sample: Sample) -> int:
    """Return the number of runs per base sample."""
    return (2 if sample.number("second_order") else 1) * len(sample.factors) + 2


def estimates(means: Floats, factors: int) -> dict[str, Floats]:
    """Return indices from the means of the statistics, (..., columns); NaN where nothing varies.

    first_order, total_order (..., factor): Saltelli et al. (2010), Table 2 (b) and (f);
    second_order (..., pair): Saltelli (2002), Theorem 2.

    Of a parameter that the model never sees, AB = A, and B (AB - A) and (A - AB)^2 are zero to the
    last digit, whatever the sample: there is no noise that all indices share, and the dummy of
    Khorashadi Zadeh et al. (2017), whose estimators are other ones, is no floor of these. The
    noise of an index is its own interval.
    """
    a, b, squared_a, squared_b = np.moveaxis(means[..., :_ALONE], -1, 0)
    centre = ((a + b) / 2) ** 2
    variance = (squared_a + squared_b) / 2 - centre
    variance = np.where(variance > np.finfo(float).eps, variance, np.nan)
    shares = means[..., _ALONE:] / variance[..., None]
    first, total, joint = np.split(shares, [factors, 2 * factors], axis=-1)
    found = {"first_order": first, "total_order": total}
    if joint.shape[-1]:
        one, other = np.triu_indices(factors, 1)
        found["second_order"] = joint - first[..., one] - first[..., other]
    return found


HALVINGS = 5  # number of halvings of the sample that show how its indices settle: from N/32 on
FEWEST = 8  # base samples below which halves are not shown
_2010 = "Saltelli et al. (2010), Comput. Phys. Commun. 181, 259, Table 2"
_2002 = "Saltelli (2002), Comput. Phys. Commun. 145, 280, Theorem 2"
_NESTED = "from the first base samples alone, which are a smaller sample of the same kind"
_INDICES = {
    "first_order": Index("first-order Sobol index", f"{_2010} (b)"),
    "total_order": Index("total-order Sobol index", f"{_2010} (f)"),
    "second_order": Index("second-order Sobol index", _2002, PAIR),
    "first_order_by_samples": Index(
        "first-order Sobol index by base samples", f"{_2010} (b)", BY_SAMPLES, comment=_NESTED
    ),
    "total_order_by_samples": Index(
        "total-order Sobol index by base samples", f"{_2010} (f)", BY_SAMPLES, comment=_NESTED
    ),
}


def check(sample: Sample) -> None:
    """Raise ValueError when the number of runs does not fit the sample."""
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
    series = [_of_first(size, outputs, sample, response) for size in base_samples(sample)]
    found, gap = dict(series[-1]), np.full(len(sample.factors), np.nan)
    for order in ("first_order", "total_order"):
        for ending in ("", "_interval"):
            values = [part.get(f"{order}{ending}", gap) for part in series]
            found[f"{order}_by_samples{ending}"] = np.stack(values)
    return found


def _of_first(size: int, outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    """Return the indices on the first base samples; none where these do not vary."""
    start, factors = outputs[: size * step(sample)], len(sample.factors)
    if still(start, varying(start, sample)):
        return {}
    parts = Outputs.of(start, sample)  # pairs have intervals on the whole sample alone
    interactions = start.size == outputs.size
    statistics = parts.resampled(interactions, sample.rng(response, "groups"))
    spread = half_widths(statistics, lambda means: estimates(means, factors), sample, response)
    found = points(parts) | spread
    if "second_order_interval" in found:
        found["second_order_interval"] = _matrix(found["second_order_interval"], factors)
    return found


def points(outputs: Outputs) -> dict[str, Floats]:
    """Return SALib's indices: first_order, total_order (factor) and second_order, symmetric."""
    factors, (a, b) = outputs.factors, outputs.at(0, -1)
    columns = range(1, 1 + factors)
    found = {
        "first_order": np.array([sobol.first_order(a, *outputs.at(i), b) for i in columns]),
        "total_order": np.array([sobol.total_order(a, *outputs.at(i), b) for i in columns]),
    }
    if outputs.second:
        pairs = combinations(columns, 2)
        joint = [sobol.second_order(a, *outputs.at(i, j, factors + i), b) for i, j in pairs]
        found["second_order"] = _matrix(np.array(joint, float), factors)
    return found


def _matrix(values: Floats, factors: int) -> Floats:
    """Return values of pairs as a symmetric matrix, NaN on its diagonal."""
    matrix = np.full((factors, factors), np.nan)
    matrix[np.triu_indices(factors, 1)] = values
    return np.where(np.isnan(matrix), matrix.T, matrix)


METHOD = Method("sobol", _INDICES, check, _estimate, varying)
