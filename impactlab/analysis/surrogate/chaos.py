"""Polynomial chaos: sums of products of Legendre polynomials on the unit cube.

Its Sobol indices are shares of the sum of its squared coefficients: Sudret (2008), Reliab. Eng.
Syst. Saf. 93, 964, eqs. 36 to 39.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

Degrees = NDArray[np.int64]
"""(terms, parameters): the degree of each term's polynomial in each parameter."""

_NORM = 0.7
"""q of the norm: with 1 all terms up to a total degree; with less, fewer interactions."""
_ROUNDING = 1e-9


def candidates(parameters: int, most: int, highest: int) -> Degrees:
    """Return the largest hyperbolic set of at most `most` terms, the constant first.

    A set holds the terms whose degrees a_i keep to (sum a_i^q)^(1/q) <= p with q = 0.7; p is at
    most `highest`. Blatman and Sudret (2011), J. Comput. Phys. 230, 2345, eq. 24.
    """
    found = hyperbolic(parameters, 0)
    for degree in range(1, highest + 1):
        larger = hyperbolic(parameters, degree)
        if len(larger) > most:
            break
        found = larger
    return found


@cache
def hyperbolic(parameters: int, degree: int) -> Degrees:
    """Return all terms up to this degree, sorted by total degree, then by parameter."""
    rows = [(0,) * parameters, *_within(parameters, degree)]
    rows.sort(key=lambda row: (sum(row), [-part for part in row]))
    return np.array(rows, dtype=np.int64)


def _within(parameters: int, degree: int) -> list[tuple[int, ...]]:
    """Return all terms but the constant, each grown from one without its last parameter."""
    limit = degree**_NORM + _ROUNDING
    found: list[tuple[int, ...]] = []
    grown = [((0,) * parameters, 0, 0.0)]
    while grown:
        row, start, used = grown.pop()
        for at in range(start, parameters):
            for part in range(1, degree + 1):
                total = used + part**_NORM
                if total > limit:
                    break
                longer = (*row[:at], part, *row[at + 1 :])
                found.append(longer)
                grown.append((longer, at + 1, total))
    return found


Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chaos:
    """A fitted response, which predicts when called with points.

    degrees: (terms, parameters). coefficients: (terms,), in the response's unit.
    """

    degrees: Degrees
    coefficients: Array

    def __call__(self, unit: Array) -> Array:
        """Return the response at points of the unit cube, (points, parameters) to (points,)."""
        return np.asarray(self.coefficients @ basis(unit, self.degrees))


def basis(unit: Array, degrees: Degrees) -> Array:
    """Return every term at every point of the unit cube, (points, parameters) to (terms, points).

    A term is a product of Legendre polynomials sqrt(2 a + 1) P_a(2 u - 1), by recurrence: of mean
    zero and variance one, and uncorrelated with every other term, where u is uniform.
    """
    highest = int(degrees.max(initial=0))
    scale = np.sqrt(2 * np.arange(highest + 1) + 1)[:, np.newaxis]
    product = np.ones((len(degrees), len(unit)))
    for values, column in zip(unit.T, degrees.T, strict=True):
        single = scale * legvander(2 * values - 1, highest).T
        active = np.flatnonzero(column)
        product[active] *= single[column[active]]
    return product


@dataclass(frozen=True)
class Indices:
    """Indices and half-widths of their intervals, each (labels,)."""

    first_order: Array
    total_order: Array
    first_order_interval: Array
    total_order_interval: Array


@dataclass(frozen=True)
class Errors:
    """Errors on held-out runs.

    q2: 1 - mean squared error / variance; rmse: root of the mean squared error.
    """

    q2: float
    rmse: float

    @property
    def missed(self) -> float:
        """Share of the variance that is not predicted, from 0 to 1."""
        return min(max(1 - self.q2, 0.0), 1.0)


@dataclass(frozen=True)
class Fitted:
    """Runs that a chaos was fitted to: unit (runs, parameters), values (runs,), block (runs,)."""

    unit: Array
    values: Array
    block: NDArray[np.int64]


def indices(
    chaos: Chaos, groups: Sequence[str], runs: Fitted, errors: Errors, confidence: float
) -> Indices:
    """Return indices of first and total order, with intervals.

    groups: of each parameter. errors: on runs held out. A half-width is the sum of two parts: the
    scatter of the coefficients (the linearised bootstrap of whole blocks of runs, their residuals
    as large as the errors on runs held out; the choice of terms is taken as given), and the share
    of the variance that the chaos misses, for it may belong to any parameter. All NaN where the
    chaos is a constant.
    """
    alone, taking_part = _members(chaos, groups)
    varying = chaos.degrees.any(axis=1)
    whole = (chaos.coefficients[varying] ** 2).sum() or np.nan
    influence = _influence(chaos, runs, errors.rmse)
    factor = float(scipy.stats.norm.ppf((1 + confidence) / 2))

    def index(members: NDArray[np.bool_]) -> Array:
        return members @ chaos.coefficients**2 / whole

    def half_width(members: NDArray[np.bool_]) -> Array:
        gradient = members - np.outer(index(members), varying)
        scatter = 2 * gradient * chaos.coefficients / whole @ influence
        return np.asarray(factor * np.sqrt((scatter**2).sum(axis=1)) + errors.missed)

    return Indices(index(alone), index(taking_part), half_width(alone), half_width(taking_part))


def _members(chaos: Chaos, groups: Sequence[str]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return masks (labels, terms): terms of the label alone, and all terms with the label."""
    labels = list(dict.fromkeys(groups))
    belongs = np.array([[group == label for label in labels] for group in groups])
    taking_part = ((chaos.degrees > 0).astype(int) @ belongs > 0).T
    return taking_part & (taking_part.sum(axis=0) == 1), taking_part


def _influence(chaos: Chaos, runs: Fitted, rmse: float) -> Array:
    """Return the influence of each block of runs on each coefficient, (terms, blocks).

    Their outer product is the covariance of the coefficients that is robust to dependence within
    blocks: Liang and Zeger (1986), Biometrika 73, 13. The residuals are scaled to the error on
    runs held out: a fit of many terms to few blocks leaves residuals far smaller than that.
    """
    columns = basis(runs.unit, chaos.degrees)
    residual = runs.values - chaos.coefficients @ columns
    size = float(np.sqrt(np.mean(residual**2))) or 1.0
    scores = columns * residual * (rmse / size)
    starts = np.flatnonzero(np.diff(runs.block, prepend=-1))
    pulls = np.add.reduceat(scores, starts, axis=1)
    return np.asarray(np.linalg.solve(columns @ columns.T, pulls))
