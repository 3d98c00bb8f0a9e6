"""Whether a surrogate may stand in for the solver."""

from __future__ import annotations

import numpy as np

from impactlab.analysis.surrogate.chaos import Array
from impactlab.analysis.verdicts import ROUND_OFF, Verdict

GOOD = 0.9
"""Predictivity on held-out runs from which on a surrogate needs no warning."""
MOSTLY = 0.9
FEW = 20
"""Distinct values up to which a response jumps between levels, where each comes ten times."""


class SurrogateVerdict(Verdict):
    """What a surrogate of a response is worth."""

    USABLE = 0, True, "it predicts at least 90 % of the variance of runs held out"
    POOR = 1, False, "it misses more than a tenth of the variance of runs held out"
    JUMPS = 2, False, "the response jumps between few values, which no polynomial follows"
    MOSTLY_CONSTANT = 3, False, "nine runs in ten share one value: it follows the others badly"
    FAILED_RUNS = 4, False, "runs are missing: it knows nothing of where they failed"
    TOO_FEW_RUNS = 5, False, "too few runs answered to fit and to test one: there is none"
    CONSTANT = 6, False, "the response does not vary: there is none"


def before_fitting(values: Array, enough: bool) -> SurrogateVerdict:
    """What the runs alone say; values: (runs,), NaN where missing.

    enough: whether there are runs enough to fit and to test.
    """
    found = values[np.isfinite(values)]
    if not enough or found.size == 0:
        return SurrogateVerdict.TOO_FEW_RUNS
    if np.ptp(found) <= ROUND_OFF * np.abs(found).max():
        return SurrogateVerdict.CONSTANT
    if found.size < values.size:
        return SurrogateVerdict.FAILED_RUNS
    counts = np.unique(found, return_counts=True)[1]
    if counts.max() >= MOSTLY * found.size:
        return SurrogateVerdict.MOSTLY_CONSTANT
    return (
        SurrogateVerdict.JUMPS
        if counts.size <= min(FEW, found.size // 10)
        else SurrogateVerdict.USABLE
    )


def after_testing(before: SurrogateVerdict, predictivity: float) -> SurrogateVerdict:
    """The same, or poor where nothing worse is known; NaN is poor, too."""
    poor = before is SurrogateVerdict.USABLE and not predictivity >= GOOD
    return SurrogateVerdict.POOR if poor else before
