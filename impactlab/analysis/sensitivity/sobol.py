"""Sobol indices with bootstrap intervals, from a Saltelli sample, by SALib's estimators.

SALib answers a NaN or a constant output with indices of zero, takes seed 0 for no seed, and needs a
minute per output for its intervals. It gets complete and varying outputs alone, and gives the
indices; the intervals are those of its bootstrap, from the same estimators as functions of means
over the base samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from SALib.analyze import sobol
from SALib.analyze.sobol import separate_output_values

from impactlab.analysis.sample import Sample
from impactlab.analysis.sensitivity.method import (
    BY_SAMPLES,
    PAIR,
    Index,
    SensitivityMethod,
    half_widths,
)
from impactlab.analysis.sensitivity.verdict import still
from impactlab.types import Floats

_ALONE = 4  # columns of the statistics that belong to no factor: a, b, a^2, b^2


@dataclass(frozen=True)
class Outputs:
    """Outputs of one response at the points of a Saltelli sample, standardised as a whole.

    a, b: (base samples,), at the two independent samples; ab: (base samples, factors), at A with
    the factor's columns from B; ba: the same at B with columns from A, None without second order.
    """

    a: Floats
    b: Floats
    ab: Floats
    ba: Floats | None

    @classmethod
    def of(cls, outputs: Floats, sample: Sample) -> Outputs:
        """Return the parts of outputs (runs,) in SALib's order, not all equal."""
        standard = (outputs - outputs.mean()) / outputs.std()
        size, second = len(outputs) // step(sample), bool(sample.number("second_order"))
        return cls(*separate_output_values(standard, len(sample.factors), size, second))

    def statistics(self, interactions: bool = True) -> Floats:
        """Return the columns whose means the estimators take, (base samples, columns)."""
        a, b = self.a[:, None], self.b[:, None]
        columns = [a, b, a**2, b**2, b * (self.ab - a), (a - self.ab) ** 2 / 2]
        if self.ba is not None and interactions:
            first, second = np.triu_indices(self.ab.shape[1], 1)
            columns.append(self.ba[:, first] * self.ab[:, second] - a * b)
        return np.concatenate(columns, axis=1)


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


HALVINGS = 5
"""Number of halvings of the sample that show how its indices settle: from N/32 on."""
FEWEST = 8
"""Base samples below which halves are not shown."""
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
    statistics = parts.statistics(interactions=start.size == outputs.size)
    spread = half_widths(statistics, lambda means: estimates(means, factors), sample, response)
    found = points(parts) | spread
    if "second_order_interval" in found:
        found["second_order_interval"] = _matrix(found["second_order_interval"], factors)
    return found


def points(outputs: Outputs) -> dict[str, Floats]:
    """Return SALib's indices: first_order, total_order (factor) and second_order, symmetric."""
    a, b, ab, ba = outputs.a, outputs.b, outputs.ab, outputs.ba
    found = {
        "first_order": np.array([sobol.first_order(a, column, b) for column in ab.T]),
        "total_order": np.array([sobol.total_order(a, column, b) for column in ab.T]),
    }
    if ba is not None:
        pairs = zip(*np.triu_indices(ab.shape[1], 1), strict=True)
        joint = [sobol.second_order(a, ab[:, i], ab[:, j], ba[:, i], b) for i, j in pairs]
        found["second_order"] = _matrix(np.array(joint, float), ab.shape[1])
    return found


def _matrix(values: Floats, factors: int) -> Floats:
    """Return values of pairs as a symmetric matrix, NaN on its diagonal."""
    matrix = np.full((factors, factors), np.nan)
    matrix[np.triu_indices(factors, 1)] = values
    return np.where(np.isnan(matrix), matrix.T, matrix)


METHOD = SensitivityMethod("sobol", _INDICES, check, _estimate, varying)
