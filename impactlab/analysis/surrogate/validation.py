"""Errors of a surrogate: how much of the variance it predicts, and how its error grows outwards."""

from __future__ import annotations

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import NDArray

from impactlab.analysis.surrogate.chaos import Chaos, basis
from impactlab.types import Floats

LEVEL = 0.95
"""Confidence level of the errors and of Q²."""
_GROWTHS = np.linspace(1.0, 4.0, 31)


def predictivity(
    errors: Floats, values: Floats, block: NDArray[np.int64], places: int
) -> tuple[float, float]:
    """Return Q² of runs that were left out, and the lower end of its interval.

    errors, values, block: (runs,); errors within a block depend on each other. places: how many
    of the runs are no near-copies of others. Q² is 1 less the mean squared
    error over the variance. The interval takes the logarithm of their ratio as normal, with the
    scatter of a jackknife over blocks: Efron and Tibshirani (1993), An Introduction to the
    Bootstrap, section 11.5 (recalled, not read). One place more, off by the whole variance, is
    added: few places do not show a rare regime. -inf where the values are all equal.
    """
    starts = np.flatnonzero(np.diff(block, prepend=-1))
    square = np.add.reduceat(errors**2, starts)
    spread = np.add.reduceat((values - values.mean()) ** 2, starts)
    count = square.size
    if spread.sum() <= 0 or count < 2:
        return -np.inf, -np.inf
    ratio = float(square.sum() / spread.sum())
    with np.errstate(divide="ignore", invalid="ignore"):
        without = np.log((square.sum() - square) / (spread.sum() - spread))
        scatter = np.sqrt((count - 1) * np.var(without)) if ratio > 0 else 0.0
    if not np.isfinite(scatter):  # all of the error, or of the variance, is in one block
        return 1 - ratio, -np.inf
    student = float(scipy.stats.t.ppf((1 + LEVEL) / 2, count - 1))
    return 1 - ratio, float(1 - ratio * np.exp(student * scatter) - 1 / places)


def error_model(leverages: Floats, errors: Floats) -> dict[str, float]:
    """Return how the error of a surrogate grows with the leverage of a point (see `leverage`).

    leverages, errors: of runs that were left out, both (runs,). Returns, by their names in an
    analysis: error, the half-width of the interval of a prediction where the leverage is 1 or less,
    in the response's unit; error_growth, the power of a larger leverage that the squared error
    grows with; and reach, the highest leverage.

    The growth is the largest that the likelihood of normal errors does not exclude, and 1 at
    least, as of a least-squares fit; the error is the quantile of the errors, each over its
    leverage to that power, that holds the share LEVEL of further ones: Lei et al. (2018), J.
    Am. Stat. Assoc. 113, 1094, section 5.2 (recalled, not read).

    The error does not fall below that at the average leverage, 1: in the middle the terms of the
    chaos are small, but those that it lacks are not. With one parameter anywhere in its range and
    the others at their medians, the intervals of 200 surrogates of 400 impacts in 8 parameters
    (studies/sobol.yaml) hold the solver's answer in 97 to 100 % per response, and in 88 to 100 %
    per response and parameter (tests/benchmarks/surrogate_coverage.py).
    """
    outward = np.maximum(leverages, 1.0)
    scaled = errors**2 / outward ** _GROWTHS[:, np.newaxis]
    mean = np.maximum(scaled.mean(axis=1), np.finfo(float).tiny)
    likelihood = -(_GROWTHS * np.log(outward).sum() + errors.size * np.log(mean)) / 2
    threshold = likelihood.max() - scipy.stats.chi2.ppf(LEVEL, 1) / 2
    largest = int(np.flatnonzero(likelihood >= threshold)[-1])
    ranked = np.sort(np.sqrt(scaled[largest]))
    rank = min(int(np.ceil(LEVEL * (errors.size + 1))), errors.size)
    return {
        "error": float(ranked[rank - 1]),
        "error_growth": float(_GROWTHS[largest]),
        "reach": float(leverages.max()),
    }


def half_width(leverage: Floats, error: Floats, growth: Floats) -> Floats:
    """Return half-widths of the intervals of predictions (see `error_model`)."""
    return np.asarray(error * np.maximum(leverage, 1.0) ** (growth / 2))


def leverage(chaos: Chaos, inputs: Floats) -> Floats:
    """Return the mean square of the terms at points, (points, parameters) to (points,).

    It is 1 on average over the distributions, and large at the ends of ranges and in corners: the
    terms that a fit lacks, and the errors of those that it has, grow as its terms do.
    """
    return np.asarray((basis(inputs, chaos.degrees, chaos.polynomials) ** 2).mean(axis=0))
