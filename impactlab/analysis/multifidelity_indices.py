"""Sobol indices of a slow model from few of its runs and many of a fast model of the same thing.

With a line through the pairs the slow output is y = a + b x + r, of the fast output x and a rest r
that does not correlate with it. P x is the part of x that an index counts: its expectation for a
value of the parameter (first order), or what differs from its expectation for values of all other
parameters (total order). Then

    Var(P y) = b² Var(P x) + 2 b Cov(P x, r) + Var(P r).

Runs of the fast model give the first term and P x at the pairs, the pairs give the second, and the
third lies between 0 and Var(r), which the pairs give, too: few of them tell no more. The interval
holds both ends, each with its error by the jackknife over the pairs, and is thus wider than its
level asks for where the rest is of other parameters. Sobol' (2001), Math. Comput. Simul. 55, 271.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.types import Floats


@dataclass(frozen=True)
class FastIndex:
    """An index of the fast model.

    value: the index; error: its standard error. parts: P x at the pairs, (pairs,), each right in
    the mean.
    """

    value: float
    error: float
    parts: Floats


def first_order(outputs: Floats, second: Floats, mixed: Floats, parts: Floats) -> FastIndex:
    """Return an index of first order: Saltelli and others (2010), Comput. Phys. Commun. 181, 259.

    outputs, second: (base samples,), at two independent draws; mixed: at the first ones with the
    parameter of the second ones. parts: (redraws, pairs), at the parameter of the pairs, all other
    parameters drawn anew.
    """
    mean = np.mean([outputs, second])
    shares = (second - mean) * (mixed - outputs)
    return _ratio(shares, outputs, second, parts.mean(axis=0))


def total_order(
    outputs: Floats, second: Floats, mixed: Floats, parts: Floats, low: Floats
) -> FastIndex:
    """Return an index of total order: Jansen (1999), Comput. Phys. Commun. 117, 35.

    As `first_order`, but parts: at the pairs, the parameter drawn anew; low: outputs at the pairs.
    """
    return _ratio((outputs - mixed) ** 2 / 2, outputs, second, low - parts.mean(axis=0))


def _ratio(shares: Floats, outputs: Floats, second: Floats, parts: Floats) -> FastIndex:
    """Return the mean share of the variance, and its error by the derivative of the ratio."""
    mean = np.mean([outputs, second])
    variances = ((outputs - mean) ** 2 + (second - mean) ** 2) / 2
    value = shares.mean() / variances.mean()
    spread = (shares - value * variances).std(ddof=1) / variances.mean()
    return FastIndex(float(value), float(spread / np.sqrt(shares.size)), parts)


def slow_index(
    low: Floats, high: Floats, variance: float, fast: FastIndex, confidence: float
) -> tuple[float, float, float]:
    """Return an index of the slow model and the ends of its interval, all from 0 to 1.

    low, high: outputs at the pairs, (pairs,). variance: of the fast model. As a value, the rest
    scatters by the parameters as the fast model does. The less the models correlate, the wider the
    interval: without any correlation it is nearly all from 0 to 1.
    """
    pairs = high.size
    ends = _ends(low, high, variance, fast)
    reduced = []
    for pair in range(pairs):
        fewer = [np.delete(column, pair) for column in (low, high, fast.parts)]
        reduced.append(_ends(fewer[0], fewer[1], variance, replace(fast, parts=fewer[2])))
    pseudo = pairs * ends - (pairs - 1) * np.array(reduced)
    error = (1.0 - (ends[1] - ends[0])) * fast.error  # of the variance that is the fast model's
    errors = np.sqrt(pseudo.var(axis=0, ddof=1) / pairs + error**2)
    factor = scipy.stats.t.ppf(0.5 + confidence / 2, pairs // 2 - 1)
    low_end, high_end = pseudo.mean(axis=0) + factor * errors * [-1, 1]
    low_end, high_end = np.clip([low_end, max(high_end, low_end)], 0.0, 1.0).tolist()
    value = ends[0] + (ends[1] - ends[0]) * min(max(fast.value, 0.0), 1.0)
    return float(np.clip(value, low_end, high_end)), low_end, high_end


def _ends(low: Floats, high: Floats, variance: float, fast: FastIndex) -> Floats:
    """Return the index if the parameter has no part in the rest, and if it has all of it."""
    about = low - low.mean()
    slope = about @ high / (about @ about)
    rest = high - high.mean() - slope * about
    unknown = rest @ rest / (high.size - 2)
    shared = (fast.parts - fast.parts.mean()) @ rest / (high.size - 1)
    total = slope**2 * variance + unknown
    least = (slope**2 * variance * fast.value + 2 * slope * shared) / total
    return np.array([least, least + unknown / total])
