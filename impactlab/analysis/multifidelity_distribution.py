"""The distribution of a slow model by a line through its pairs with a fast one; outer quantiles.

The interval of an outer quantile holds the outputs at which the distribution function, estimated as
every probability is (multifidelity.py), differs from that of the quantile by no more than its
error. The pairs beyond an output are few, and their scatter is too small where none is there: the
error is at least that of runs with the quantile's probability, of whose variance the line leaves a
share untold. Woodruff (1952), J. Am. Stat. Assoc. 47, 635; Wilson (1927), ibid. 22, 209 (both
recalled, not read).
"""

from collections.abc import Callable

import numpy as np
import scipy  # its stats and special are loaded when first used

from impactlab.types import Floats

Statistic = Callable[[Floats, Floats, Floats, Floats], tuple[Floats, Floats, Floats]]
Fit = Callable[[Floats, Floats, Floats], tuple[Floats, Floats, Floats]]
LIMITS = 400
"""Outputs at which the distribution function is inverted."""


def line_through(low: Floats, high: Floats, every: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the line of the pairs at them and at every low output, and the errors about it."""
    about = low - low.mean()
    slope = about @ high / (about @ about)
    line = high.mean() + slope * about
    return line, high.mean() + slope * (every - low.mean()), high - line


def parabola_through(low: Floats, high: Floats, every: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the parabola of the pairs at them and at every low output, and the errors about it."""
    mean, size = low.mean(), low.std()
    parabola = np.polynomial.Polynomial.fit(low, high, 2, domain=[mean - size, mean + size])
    return parabola(low), parabola(every), high - parabola(low)


def spread(errors: Floats) -> float:
    """Return the standard deviation about a line, for which two of the errors are not free."""
    return float(errors.std() * np.sqrt(errors.size / (errors.size - 2)))


def beyond_limit(limit: float) -> Statistic:
    """Return what gives the shares of runs beyond a limit, for errors that are normal."""

    def shares_beyond(
        line: Floats, every: Floats, errors: Floats, high: Floats
    ) -> tuple[Floats, Floats, Floats]:
        width = spread(errors)

        def share(values: Floats) -> Floats:
            if width == 0.0:
                return np.asarray(values > limit, dtype=float)
            return np.asarray(scipy.special.ndtr((values - limit) / width))

        return share(every), np.asarray(high > limit, dtype=float), share(line)

    return shares_beyond


def limits_of(every: Floats, high: Floats, width: float) -> Floats:
    """Return outputs from far below all of both models to far above."""
    outputs = np.concatenate([every, high])
    return np.linspace(outputs.min() - 3.0 * width, outputs.max() + 3.0 * width, LIMITS)


def rising(values: Floats) -> Floats:
    """Return the mean of the least rising curve above values and of the greatest below."""
    above = np.maximum.accumulate(values)
    return (above + np.minimum.accumulate(values[::-1])[::-1]) / 2


def outer_quantile(
    line: Floats,
    every: Floats,
    errors: Floats,
    high: Floats,
    probability: float,
    confidence: float,
) -> tuple[float, float, tuple[float, float], float]:
    """Return a quantile, its standard error, its interval, and the error of slow runs alone.

    line: expected of the slow model at the pairs, and every: at each fast run. high: outputs at the
    pairs; errors: of these about the line. Raises ValueError where the interval has no end.
    """
    pairs, limits = high.size, limits_of(every, high, spread(errors))
    below, variances, fast_variances = (np.empty(LIMITS) for _ in range(3))
    for row, limit in enumerate(limits):
        shares, values, expected = beyond_limit(limit)(line, every, errors, high)
        untold = values - expected
        below[row] = 1.0 - shares.mean() - untold.mean()
        total = max(shares.mean() * (1 - shares.mean()), 1e-12)
        share = min(float((shares * (1 - shares)).mean() / total), 1.0)
        variances[row] = max(share * probability * (1 - probability), untold.var(ddof=1))
        fast_variances[row] = shares.var() / every.size
    factor = scipy.stats.t.ppf(0.5 + confidence / 2, pairs // 2 - 1)
    margins = np.sqrt(variances / pairs + fast_variances)
    inside = np.flatnonzero(np.abs(below - probability) <= factor * margins)
    value = float(np.interp(probability, rising(below), limits))
    nearest = int(np.abs(limits - value).argmin())
    first, last = (int(inside[0]), int(inside[-1])) if inside.size else (nearest, nearest)
    if first == 0 or last == LIMITS - 1:
        raise ValueError("the interval has no end: add runs of high")
    low_end = min(float(limits[first - 1]), value)  # the interval ends between two limits
    high_end = max(float(limits[last + 1]), value)
    error = (high_end - low_end) / (2 * factor)
    alone = np.sqrt(probability * (1 - probability) / pairs) / margins[nearest]
    return value, error, (low_end, high_end), float(error * alone)
