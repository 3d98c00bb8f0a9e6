"""Adaptive importance sampling on the unit cube: posterior and evidence.

Cappe et al. (2004), J. Comput. Graph. Stat. 13, 907, with a defensive share of the prior
(Hesterberg 1995) and a likelihood that sharpens by stages; recalled, not read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.types import Floats

_FIRST, _LAST, _STAGES = 4096, 16384, 12
_ENOUGH = 300.0
"""Effective sample size from which on a stage is as sharp as the posterior, if it can be."""
_DEFENSIVE, _TAILS, _WIDER = 0.1, 5, 1.5
"""Of a proposal: share of the prior, degrees of freedom, and variance over the posterior's."""


@dataclass(frozen=True)
class Posterior:
    """Weighted points of the prior's unit cube, (points, parameters); weights add up to one."""

    points: Floats
    weights: Floats
    log_evidence: float

    @property
    def effective(self) -> float:
        """Effective sample size: Kong (1992)."""
        return float(1.0 / (self.weights**2).sum()) if np.isfinite(self.weights).all() else 0.0


def posterior(
    log_likelihood: Callable[[Floats], Floats], parameters: int, seed: int, last: int = _LAST
) -> Posterior:
    """Sample a posterior under a uniform prior on the unit cube.

    Each stage draws from a t distribution fitted to the last one, and from the prior; the first
    ones see a flattened likelihood, so that none misses the posterior. last: points of the last
    stage.
    """
    rng = np.random.default_rng(seed)
    points = scipy.stats.qmc.Sobol(parameters, rng=rng).random(_FIRST)
    log_ratio = log_likelihood(points)
    proposed = np.zeros(_FIRST)
    for _ in range(_STAGES):
        power = _sharpest(log_ratio, proposed)
        weights = normalised(power * log_ratio - proposed)
        mean = weights @ points
        spread = np.cov(points.T, aweights=weights, ddof=0).reshape(parameters, parameters)
        shape = _WIDER * spread * (_TAILS - 2) / _TAILS + 1e-14 * np.eye(parameters)
        proposal = scipy.stats.multivariate_t(mean, shape, df=_TAILS, allow_singular=True)
        count = last if power == 1.0 else _FIRST
        flat = round(_DEFENSIVE * count)
        drawn = np.reshape(proposal.rvs(count - flat, random_state=rng), (-1, parameters))
        points = np.concatenate([rng.random((flat, parameters)), drawn])
        inside = np.all((points > 0) & (points < 1), axis=1)
        points = np.where(inside[:, np.newaxis], points, 0.5)
        log_ratio = np.where(inside, log_likelihood(points), -np.inf)
        density = np.log1p(-_DEFENSIVE) + np.reshape(proposal.logpdf(points), -1)
        proposed = np.logaddexp(np.log(_DEFENSIVE), density)
        if power == 1.0:
            break
    log_weights = log_ratio - proposed
    evidence = float(scipy.special.logsumexp(log_weights)) - np.log(log_weights.size)
    return Posterior(points, normalised(log_weights), evidence)


def normalised(log_weights: Floats) -> Floats:
    """Return weights that add up to one, from their logarithms."""
    weights = np.exp(log_weights - log_weights.max())
    return np.asarray(weights / weights.sum())


def _sharpest(log_likelihood: Floats, proposed: Floats) -> float:
    """Return the largest power of the likelihood, up to 1, that leaves enough effective points."""
    finite = np.where(np.isfinite(log_likelihood), log_likelihood, -1e300)

    def enough(power: float) -> bool:
        with np.errstate(over="ignore"):
            weights = normalised(power * finite - proposed)
        return bool(1.0 / (weights**2).sum() >= _ENOUGH)

    low, high = 0.0, 1.0
    if enough(high):
        return high
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if enough(middle) else (low, middle)
    return max(low, 1e-12)
