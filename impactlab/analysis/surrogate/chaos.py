"""Sparse polynomial chaos: sums of products of the parameters' orthonormal polynomials.

Hybrid least angle regression picks the terms, and least squares fits their coefficients: Blatman
and Sudret (2011), J. Comput. Phys. 230, 2345, section 4.3. The Sobol indices are shares of the sum
of the squared coefficients: Sudret (2008), Reliab. Eng. Syst. Saf. 93, 964, eqs. 36 to 39.

The variable of a polynomial is the parameter itself, or its logarithm where the distribution is
logarithmic, less its mean, over its standard deviation: in probabilities a normal parameter would
be S-shaped, which no polynomial follows at the ends. The recurrence coefficients come from
Stieltjes' procedure on a fine quadrature of the density, so that one procedure covers every
distribution: Gautschi (2004), Orthogonal Polynomials, section 2.2.3 (recalled, not read). For a
uniform parameter they are Legendre's, for a normal one Hermite's: Xiu and Karniadakis (2002), SIAM
J. Sci. Comput. 24, 619.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.surrogate.least_angle import terms_in_order
from impactlab.methods.entries import Distribution
from impactlab.types import Floats

HIGHEST_DEGREE = 20


@dataclass(frozen=True)
class Polynomials:
    """The polynomials of one parameter, up to HIGHEST_DEGREE.

    logarithmic: whether they take the logarithm of the value. centre, scale: mean and standard
    deviation of what they take. diagonal, beside: recurrence coefficients a_n and b_n, n from 0
    (b_0 is not used), for the standardised variable z:
    b_(n+1) p_(n+1) = (z - a_n) p_n - b_n p_(n-1).
    """

    logarithmic: bool
    centre: float
    scale: float
    diagonal: tuple[float, ...]
    beside: tuple[float, ...]

    def standardised(self, values: Floats) -> Floats:
        """Return values in SI units less their mean, over their standard deviation."""
        plain = np.log(values) if self.logarithmic else values
        return np.asarray((plain - self.centre) / self.scale)

    def __call__(self, standardised: Floats, highest: int) -> Floats:
        """Return the polynomials of degree 0 to `highest`, (degrees, points)."""
        polynomials = np.ones((highest + 1, standardised.size))
        below = np.zeros(standardised.size)
        for n in range(highest):
            raised = (standardised - self.diagonal[n]) * polynomials[n] - self.beside[n] * below
            below, polynomials[n + 1] = polynomials[n], raised / self.beside[n + 1]
        return polynomials


@cache
def orthonormal(distribution: Distribution) -> Polynomials:
    """Return the polynomials of a distribution."""
    nodes, weights = distribution.quadrature()
    centre = float(weights @ nodes)
    scale = float(np.sqrt(weights @ (nodes - centre) ** 2))
    z = (nodes - centre) / scale
    diagonal, beside = [], [0.0]
    below, present = np.zeros(z.size), np.ones(z.size)
    for _ in range(HIGHEST_DEGREE + 1):
        diagonal.append(float(weights @ (z * present**2)))
        raised = (z - diagonal[-1]) * present - beside[-1] * below
        beside.append(float(np.sqrt(weights @ raised**2)))
        below, present = present, raised / beside[-1]
    return Polynomials(distribution.is_logarithmic, centre, scale, tuple(diagonal), tuple(beside))


Degrees = NDArray[np.int64]
"""(terms, parameters): the degree of each term's polynomial in each parameter."""

_NORM = 0.7  # q of the norm: with 1 all terms up to a total degree; with less, fewer interactions
_ROUNDING = 1e-9


def candidates(parameters: int, most: int, highest: int) -> Degrees:
    """Return the largest hyperbolic set of at most `most` terms, the constant first.

    A set holds the terms whose degrees a_i keep to (sum a_i^q)^(1/q) <= p with q = 0.7; p is at
    most `highest`. Blatman and Sudret (2011), eq. 24.
    """
    terms = hyperbolic(parameters, 0)
    for degree in range(1, highest + 1):
        larger = hyperbolic(parameters, degree)
        if len(larger) > most:
            break
        terms = larger
    return terms


@cache
def hyperbolic(parameters: int, degree: int) -> Degrees:
    """Return all terms up to this degree, sorted by total degree, then by parameter."""
    limit = degree**_NORM + _ROUNDING
    constant = (0,) * parameters
    rows, grown = [constant], [(constant, 0, 0.0)]
    while grown:  # each term grows from the one without its last parameter
        row, start, used = grown.pop()
        for parameter in range(start, parameters):
            for part in range(1, degree + 1):
                total = used + part**_NORM
                if total > limit:
                    break
                longer = (*row[:parameter], part, *row[parameter + 1 :])
                rows.append(longer)
                grown.append((longer, parameter + 1, total))
    rows.sort(key=lambda row: (sum(row), [-part for part in row]))
    return np.array(rows, dtype=np.int64)


def basis(inputs: Floats, degrees: Degrees, polynomials: Sequence[Polynomials]) -> Floats:
    """Return every term at every point, (points, parameters) in SI units to (terms, points).

    A term is a product of one polynomial per parameter: of mean zero and variance one, and
    uncorrelated with every other term, where the parameters have the polynomials' distributions.
    """
    highest = int(degrees.max(initial=0))
    product = np.ones((len(degrees), len(inputs)))
    for values, column, kind in zip(inputs.T, degrees.T, polynomials, strict=True):
        single = kind(kind.standardised(values), highest)
        active = np.flatnonzero(column)
        product[active] *= single[column[active]]
    return product


@dataclass(frozen=True)
class Chaos:
    """A fitted response, which predicts when called with points.

    degrees: (terms, parameters). coefficients: (terms,), in the response's unit. polynomials: of
    each parameter.
    """

    degrees: Degrees
    coefficients: Floats
    polynomials: tuple[Polynomials, ...]

    def __call__(self, inputs: Floats) -> Floats:
        """Return the response at points, (points, parameters) in SI units to (points,)."""
        return np.asarray(self.coefficients @ basis(inputs, self.degrees, self.polynomials))


MOST_RUNS = 20_000  # largest number of runs that a fit uses; of more, it draws as many
_MOST_CANDIDATES = 400
_MOST_TERMS = 200
_SMALLEST = 1e-12  # least leverage left to a run, so that nothing is divided by zero


def fewest_runs(parameters: int) -> int:
    """Return the number of runs that a fit needs: four per term of the linear model."""
    return 4 * (parameters + 1)


def drawn(runs: int, seed: int) -> NDArray[np.int64]:
    """Return the positions of the runs that a fit uses, rising: all, or a draw of MOST_RUNS."""
    return np.sort(np.random.default_rng(seed).permutation(runs)[:MOST_RUNS])


def fit(inputs: Floats, values: Floats, seed: int, polynomials: Sequence[Polynomials]) -> Chaos:
    """Return a chaos that predicts `values` from points.

    inputs: (runs, parameters), in SI units; values: (runs,), finite. seed: which runs are used
    where there are more than MOST_RUNS. Raises ValueError when there are fewer than `fewest_runs`.
    """
    parameters = inputs.shape[1]
    if len(values) < fewest_runs(parameters):
        raise ValueError(
            f"{len(values)} runs are too few for a surrogate in {parameters} parameters: "
            f"solve {fewest_runs(parameters)} or more"
        )
    rows = drawn(len(values), seed)
    inputs, values = inputs[rows], values[rows]
    levels = min(
        np.unique(np.round(kind.standardised(column), 9)).size
        for kind, column in zip(polynomials, inputs.T, strict=True)
    )
    highest = min(HIGHEST_DEGREE, levels - 1)  # that the parameter of the fewest levels resolves
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        degrees = candidates(parameters, min(_MOST_CANDIDATES, len(values) // 2), highest)
        columns, mean = basis(inputs, degrees, polynomials), values.mean()
        order = _order(columns, values - mean)
        coefficients = _least_squares(columns[order], values - mean)
    coefficients[0] += mean
    return Chaos(degrees[order[: coefficients.size]], coefficients, tuple(polynomials))


def _order(columns: Floats, values: Floats) -> list[int]:
    """Return the terms in the order of least angle regression; values: of mean zero."""
    centred = columns[1:] - columns[1:].mean(axis=1, keepdims=True)
    centred /= np.linalg.norm(centred, axis=1, keepdims=True)
    # Scaled to norm one, as the terms are, because the tolerances are absolute.
    correlation = centred @ (values / (np.linalg.norm(values) or 1.0))
    most = min(_MOST_TERMS, len(values) // 4)
    return [0, *(term + 1 for term in terms_in_order(correlation, centred @ centred.T, most))]


def _least_squares(columns: Floats, values: Floats) -> Floats:
    """Return the coefficients of the first terms, as many as predict best.

    Best: the least leave-one-out error, which one QR decomposition gives for all counts at once,
    corrected for the number of terms k of n runs by (n + k)/(n - k): Blatman and Sudret (2011),
    eqs. 17 to 20, with a basis as good as orthonormal.
    """
    runs, count = columns.shape[1], np.arange(1, len(columns) + 1)
    q, r = scipy.linalg.qr(columns.T, mode="economic")
    projected = q.T @ values
    residual = values[:, np.newaxis] - np.cumsum(q * projected, axis=1)
    free = np.maximum(1 - np.cumsum(q**2, axis=1), _SMALLEST)
    error = ((residual / free) ** 2).mean(axis=0) * (runs + count) / (runs - count)
    best = int(np.argmin(error)) + 1
    return np.asarray(scipy.linalg.solve_triangular(r[:best, :best], projected[:best]))


def influence(
    chaos: Chaos, inputs: Floats, values: Floats, block: NDArray[np.int64], rmse: float
) -> Floats:
    """Return the influence of each block of runs on each coefficient, (terms, blocks).

    inputs (runs, parameters), values (runs,), block (runs,): the runs that the chaos was fitted to.
    Their outer product is the covariance of the coefficients that is robust to dependence within
    blocks: Liang and Zeger (1986), Biometrika 73, 13. The residuals are scaled to `rmse`, the error
    on runs held out: a fit of many terms to few blocks leaves residuals far smaller than that.
    """
    columns = basis(inputs, chaos.degrees, chaos.polynomials)
    residual = values - chaos.coefficients @ columns
    size = float(np.sqrt(np.mean(residual**2))) or 1.0
    scores = columns * residual * (rmse / size)
    starts = np.flatnonzero(np.diff(block, prepend=-1))
    pulls = np.add.reduceat(scores, starts, axis=1)
    return np.asarray(np.linalg.solve(columns @ columns.T, pulls))


def indices(
    chaos: Chaos, groups: Sequence[str], influence: Floats, missed: float, confidence: float
) -> dict[str, Floats]:
    """Return first_order and total_order, each (groups,) and with <name>_interval, a half-width.

    groups: of each parameter. missed: the share of the variance that the chaos does not predict on
    runs held out. A half-width is the sum of two parts: the scatter of the coefficients (the
    linearised bootstrap of whole blocks of runs, from their `influence`; the choice of terms is
    taken as given), and the share that is missed, for it may belong to any parameter. All NaN where
    the chaos is a constant.
    """
    belongs = np.array([[group == name for name in dict.fromkeys(groups)] for group in groups])
    taking_part = ((chaos.degrees > 0).astype(int) @ belongs > 0).T  # (groups, terms)
    alone = taking_part & (taking_part.sum(axis=0) == 1)
    varying = chaos.degrees.any(axis=1)
    variance = (chaos.coefficients[varying] ** 2).sum() or np.nan
    factor = float(scipy.stats.norm.ppf((1 + confidence) / 2))
    values: dict[str, Floats] = {}
    for name, members in (("first_order", alone), ("total_order", taking_part)):
        index = members @ chaos.coefficients**2 / variance
        gradient = members - np.outer(index, varying)
        scatter = 2 * gradient * chaos.coefficients / variance @ influence
        half_width = np.asarray(factor * np.sqrt((scatter**2).sum(axis=1)) + missed)
        values |= {name: index, f"{name}_interval": half_width}
    return values
