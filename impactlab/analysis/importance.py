"""Adaptive importance sampling on the unit cube: posterior and evidence, of any number of modes.

Every local maximum of the likelihood among many points of the prior starts one component of a
mixture of t distributions, which sharpens by stages to its share of the posterior: Cappe et al.
(2008), Stat. Comput. 18, 447, with a likelihood tempered per component and a defensive share of the
prior (Hesterberg 1995); recalled, not read.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
import scipy  # its stats and spatial are loaded when first used

from impactlab.types import Floats

_LAST, _STAGES, _REFINEMENTS = 16384, 60, 3
_NEIGHBOURS = 24
"""Points, with itself, among which one must be the most likely to start a component."""
_MOST, _EACH, _ENOUGH = 32, 400, 100.0
"""Largest number of components, points that each draws per stage, and least effective ones."""
_DEFENSIVE, _TAILS, _WIDER = 0.1, 5, 1.5
"""Of a proposal: share of the prior, degrees of freedom, and variance over the posterior's."""
_BINS, _SMOOTH = 2048, 0.4
"""Bins of a histogram, and its smoothing over Silverman's, which is for a single mode."""
_VALLEY, _RARE = 0.5, 0.02
"""Density between two modes over that of the lower one, and probability of a mode."""
_LEAST = 1e-4  # share of the posterior below which a component draws no more points


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


@dataclass(frozen=True)
class _Mixture:
    """Means (components, parameters), factors of the shapes, and shares, of t distributions."""

    means: Floats
    factors: Floats
    shares: Floats

    @classmethod
    def of(cls, points: Floats, weights: Floats) -> Self:
        """Fit components to weighted points; weights (components, points) add up to the shares."""
        shares = weights.sum(axis=1)
        weights = weights / shares[:, np.newaxis]
        means = weights @ points
        offsets = points - means[:, np.newaxis]
        spread = np.einsum("kn,kni,knj->kij", weights, offsets, offsets)
        shapes = _WIDER * (_TAILS - 2) / _TAILS * spread + 1e-24 * np.eye(points.shape[1])
        # by the root of their shares, so that small modes have points enough to be fitted to
        return cls(means, np.linalg.cholesky(shapes), np.sqrt(shares) / np.sqrt(shares).sum())

    def draws(self, count: int, rng: np.random.Generator) -> Floats:
        """Draw the defensive share from the prior, and the others in proportion to the shares."""
        flat = rng.random((round(_DEFENSIVE * count), self.means.shape[1]))
        places = (np.arange(count - len(flat)) + rng.random()) / (count - len(flat))
        of = np.searchsorted(np.cumsum(self.shares), places).clip(max=self.shares.size - 1)
        scale = np.sqrt(_TAILS / rng.chisquare(_TAILS, of.size))[:, np.newaxis]
        normal = rng.standard_normal((of.size, self.means.shape[1])) * scale
        return np.concatenate(
            [flat, self.means[of] + np.einsum("nij,nj->ni", self.factors[of], normal)]
        )

    def log_densities(self, points: Floats) -> Floats:
        """Return the log of each component's share times its density, (components, points)."""
        size = points.shape[1]
        offsets = (points - self.means[:, np.newaxis]).transpose(0, 2, 1)
        squares = (np.linalg.solve(self.factors, offsets) ** 2).sum(axis=1)
        volume = np.log(np.diagonal(self.factors, axis1=1, axis2=2)).sum(axis=1)
        gamma = scipy.special.gammaln([(_TAILS + size) / 2, _TAILS / 2])
        constant = gamma[0] - gamma[1] - 0.5 * size * np.log(_TAILS * np.pi)
        with np.errstate(divide="ignore"):
            scale = np.log(self.shares) - volume + constant
        return np.asarray(scale[:, np.newaxis] - 0.5 * (_TAILS + size) * np.log1p(squares / _TAILS))


def modes(column: Floats, weights: Floats) -> list[tuple[Floats, float]]:
    """Return the intervals of the unit line that hold one mode each, rising, and their weights.

    A mode is separate where the smoothed density falls to half of its peak before it rises again.
    An interval holds the central 95 % of the mode's points.
    """
    density, edges = np.histogram(column, _BINS, (0.0, 1.0), weights=weights)
    deviation = np.sqrt(weights @ (column - weights @ column) ** 2)
    width = _SMOOTH * 1.06 * deviation * (weights**2).sum() ** 0.2
    density = scipy.ndimage.gaussian_filter1d(density, width * _BINS, mode="reflect")
    peaks, about = scipy.signal.find_peaks(np.pad(density, 1), prominence=0.0)
    peaks = peaks[about["prominences"] >= (1 - _VALLEY) * density[peaks - 1]] - 1
    while True:
        valleys = [low + int(density[low:high].argmin()) for low, high in pairwise(peaks)]
        ends = np.array([0.0, *edges[valleys], 1.0])
        masses = np.histogram(column, ends, weights=weights)[0]
        if masses.size == 1 or masses.min() >= _RARE:
            break
        peaks = np.delete(peaks, masses.argmin())
    intervals = []
    for (low, high), mass in zip(pairwise(ends), masses.tolist(), strict=True):
        inside = (column >= low) & (column <= high)
        interval = np.quantile(
            column[inside], (0.025, 0.975), weights=weights[inside], method="inverted_cdf"
        )
        intervals.append((interval, mass))
    return intervals


def posterior(
    log_likelihood: Callable[[Floats], Floats], parameters: int, seed: int, last: int = _LAST
) -> Posterior:
    """Sample a posterior under a uniform prior on the unit cube.

    last: points of the last stage. A mode is missed where no point of the first sample lies in its
    basin: 4096 points in 2 parameters, 16384 in 4 or 5.
    """
    rng = np.random.default_rng(seed)
    first = 1 << min(10 + parameters, 14)
    points = scipy.stats.qmc.Sobol(parameters, rng=rng).random(first)
    mixture = _sharpened(_started(points, log_likelihood(points)), rng, log_likelihood)
    for count in (*[_EACH * len(mixture.shares)] * _REFINEMENTS, last):
        points = mixture.draws(count, rng)
        log_ratio = _within(points, log_likelihood)
        densities = mixture.log_densities(points)
        total = scipy.special.logsumexp(densities, axis=0)
        proposed = np.logaddexp(np.log(_DEFENSIVE), np.log1p(-_DEFENSIVE) + total)
        weights = normalised(log_ratio - proposed)
        belonging = np.exp(densities - total) * weights
        shares = belonging.sum(axis=1)
        alive = shares > _LEAST
        mixture = _Mixture.of(points, belonging[alive])
    evidence = float(scipy.special.logsumexp(log_ratio - proposed)) - np.log(count)
    return Posterior(np.where(weights[:, np.newaxis] > 0, points, 0.5), weights, evidence)


def _started(points: Floats, log_likelihood: Floats) -> _Mixture:
    """Return a component around each of the points that are more likely than all neighbours."""
    neighbours = scipy.spatial.KDTree(points).query(points, _NEIGHBOURS)[1]
    peaks = np.flatnonzero(log_likelihood >= log_likelihood[neighbours].max(axis=1))
    peaks = peaks[np.argsort(-log_likelihood[peaks], kind="stable")][:_MOST]
    around = np.zeros((peaks.size, len(points)))
    np.put_along_axis(around, neighbours[peaks], 1.0, axis=1)
    return _Mixture.of(points, around)


def _sharpened(
    mixture: _Mixture, rng: np.random.Generator, log_likelihood: Callable[[Floats], Floats]
) -> _Mixture:
    """Sharpen each component by its own draws alone, so that no mode draws another's to it."""
    means, factors = mixture.means.copy(), mixture.factors.copy()
    blunt = np.arange(len(means))
    for _ in range(_STAGES):
        normal = rng.standard_normal((blunt.size, _EACH, means.shape[1]))
        points = means[blunt, np.newaxis] + normal @ factors[blunt].transpose(0, 2, 1)
        log_ratio = _within(points.reshape(-1, means.shape[1]), log_likelihood)
        log_ratio = log_ratio.reshape(blunt.size, _EACH)
        powers = _sharpest(log_ratio)
        weights = normalised(powers[:, np.newaxis] * log_ratio)
        for component, column, draws in zip(blunt, weights, points, strict=True):
            single = _Mixture.of(draws, column[np.newaxis])
            means[component], factors[component] = single.means[0], single.factors[0]
        blunt = blunt[powers < 1.0]
        if not blunt.size:
            break
    return _Mixture(means, factors, mixture.shares)


def _within(points: Floats, log_likelihood: Callable[[Floats], Floats]) -> Floats:
    """Return the logarithm of the likelihood, minus infinity outside the cube."""
    inside = np.all((points > 0) & (points < 1), axis=1)
    values = log_likelihood(np.where(inside[:, np.newaxis], points, 0.5))
    return np.where(inside, values, -np.inf)


def normalised(log_weights: Floats) -> Floats:
    """Return weights that add up to one along the last axis, from their logarithms."""
    weights = np.exp(log_weights - log_weights.max(axis=-1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def _sharpest(log_likelihood: Floats) -> Floats:
    """Return the largest power up to 1 of each row that leaves enough effective points."""
    finite = np.where(np.isfinite(log_likelihood), log_likelihood, -1e300)
    low, high = np.full(len(finite), 1e-12), np.ones(len(finite))
    power = high
    for _ in range(40):
        with np.errstate(over="ignore"):
            weights = normalised(power[:, np.newaxis] * finite)
        enough = 1.0 / (weights**2).sum(axis=1) >= _ENOUGH
        low, high = np.where(enough, power, low), np.where(enough, high, power)
        power = np.sqrt(low * high)
        if np.all(low >= (1 - 1e-3) * high):
            break
    return low
