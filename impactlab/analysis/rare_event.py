"""Probability of a rare event by importance sampling, steered by the cross-entropy method.

Parameters are standard normal scores. Level by level, runs are drawn from a mixture of normal
densities, which moves towards the tenth of the runs nearest to the limit until it lies beyond
(Rubinstein 1999, Methodol. Comput. Appl. Probab. 1, 127; a mixture as in Kurtz and Song 2013,
Struct. Saf. 42, 35; both recalled, not read). The components keep one fixed width: in many
dimensions fitted covariances leave out tails, and probabilities come out too small.

The estimate comes from a last sample alone. Its density and its size were chosen by the runs
before it, so that it is unbiased, and stopping adds no error to its interval. The sample before
the last gives a second, independent estimate as a check.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import NDArray

from impactlab.types import Floats
from impactlab.verdicts import Verdict

SHARE = 0.1  # of the runs of a level, towards which the next one moves
WIDTH = 1.1
"""Standard deviation of a component; wider than the scores themselves, so that weights have a
finite variance."""
_COMPONENTS = (1, 2, 3, 4, 6, 8, 12)
_ITERATIONS = 30
_SPREAD = 0.1  # share of the draws that all components get alike
_ALL_ROUND, _LEAST_REACH = 0.2, 1.5
"""Share of the draws around the middle in all directions, as far out as the components, and their
least width: regions that the levels have missed show up in the error, and are found."""
_MARGIN = 1.2  # on the size of the last sample
_HEAVY = 0.1
SAFETY = 1.1
"""Factor on standard errors: those of skewed weights are up to 9 % too small."""
_DISAGREEING = 3.0  # standard errors between both estimates
_RAY = 33  # runs that confirm a design point
_AROUND, _AS_NEAR = 0.5, 1.03  # cosine of the angle to the nearest run; length over its length
Runs = Callable[[Floats], Floats]
Mean = Callable[[NDArray[np.bool_], NDArray[np.bool_]], tuple[float, float, float]]
"""From masks of the runs above the limit, and of those that count, to what _mean returns."""


class RareEventVerdict(Verdict):
    """Verdicts on the probability of a rare event; from NOT_REACHED on, there is none."""

    USABLE = True, "the coefficient of variation is as stated, and both estimates agree"
    MISSING = True, "runs are missing: the interval allows for each of them on either side"
    IMPRECISE = False, "the runs allowed do not give the coefficient of variation that is stated"
    HEAVY_WEIGHT = (
        False,
        "one run carries more than a tenth of the probability: the interval is too narrow",
    )
    DISAGREEING = (
        False,
        "the last two samples disagree: a way beyond the limit was perhaps missed",
    )
    NOT_REACHED = False, "the runs allowed do not reach the limit: no probability is given"


@dataclass(frozen=True)
class Mixture:
    """Normal densities: weights and widths (components,) and means (components, parameter)."""

    weights: Floats
    means: Floats
    widths: Floats

    def components(self, scores: Floats) -> Floats:
        """Return the logarithm of each weighted density at scores, (components, runs)."""
        squares = np.stack([((scores - mean) ** 2).sum(axis=1) for mean in self.means])
        scales = np.log(self.weights) - scores.shape[1] * np.log(self.widths)
        return np.asarray(scales[:, None] - squares / (2 * self.widths[:, None] ** 2))

    def log_ratio(self, scores: Floats) -> Floats:
        """Return the logarithm of the standard normal density over that of the mixture, (runs,)."""
        density = scipy.special.logsumexp(self.components(scores), axis=0)
        return np.asarray(-0.5 * (scores**2).sum(axis=1) - density)

    def draws(self, runs: int, rng: np.random.Generator) -> Floats:
        """Return scores, (runs, parameter)."""
        ends = np.cumsum(self.weights)[:-1]
        component = np.searchsorted(ends, rng.random(runs), side="right")
        normal = rng.standard_normal((runs, self.means.shape[1]))
        return np.asarray(self.means[component] + self.widths[component, None] * normal)


@dataclass(frozen=True)
class Estimate:
    """The probability of a rare event.

    low, high: ends of its interval. if_none, if_all: estimates if no missing run of the last sample
    exceeds the limit, or all do. check: the estimate of the sample before. levels: limits of the
    levels. design_point: scores of the likeliest run beyond the limit, (parameter,). runs: number
    of all runs. missing: of the last sample. placed: runs by which a Gaussian process was learned.
    outputs, weights: of the last sample, (run,).
    """

    verdict: RareEventVerdict
    runs: int
    levels: list[float]
    probability: float = np.nan
    low: float = np.nan
    high: float = np.nan
    if_none: float = np.nan
    if_all: float = np.nan
    check: float = np.nan
    coefficient_of_variation: float = np.nan
    missing: int = 0
    last_sample: int = 0
    placed: int = 0
    design_point: Floats | None = None
    outputs: Floats = field(default_factory=lambda: np.empty(0))
    weights: Floats = field(default_factory=lambda: np.empty(0))

    def beyond(self, limit: float) -> float:
        """Return the probability beyond another limit close by, from the same runs."""
        return float((self.weights * (self.outputs > limit)).sum()) / self.weights.size


def estimate(
    solve: Runs,
    parameters: int,
    limit: float,
    *,
    seed: int,
    samples: int,
    most: int,
    target: float,
    confidence: float,
) -> Estimate:
    """Return the probability that a response exceeds a limit.

    solve: from standard normal scores (runs, parameter) to the response, (runs,), NaN where it is
    missing. samples: runs per level. most: of all runs. target: coefficient of variation.
    """
    rng, ray = np.random.default_rng(seed), min(_RAY, samples)
    scores = rng.standard_normal((samples, parameters))
    log_ratio, outputs = np.zeros(samples), solve(scores)
    runs, levels, densities = samples, list[float](), list[Mixture]()
    while True:
        reached = np.where(np.isnan(outputs), -np.inf, outputs)
        level = float(np.quantile(reached, 1 - SHARE, method="lower"))
        beyond = reached > limit if level >= limit else reached >= level
        levels.append(min(level, limit))
        last = level >= limit
        stuck = len(levels) > 2 and levels[-1] <= levels[-3]
        if stuck or level == -np.inf or runs + samples * (2 if last else 1) + ray > most:
            return Estimate(RareEventVerdict.NOT_REACHED, runs, levels)
        densities.append(nearest_mixture(scores[beyond], log_ratio[beyond], rng))
        size = samples
        scores = densities[-1].draws(size, rng)
        log_ratio, outputs = densities[-1].log_ratio(scores), solve(scores)
        runs += size
        if last:
            break
    first, first_error, _ = _mean(log_ratio, outputs > limit)
    if not first:
        return Estimate(RareEventVerdict.NOT_REACHED, runs, levels)
    per_run = first_error / first * np.sqrt(samples)
    size = int(np.ceil(_MARGIN * (per_run / target) ** 2))
    size = min(max(size, samples), most - runs - ray)
    density = nearest_mixture(scores[outputs > limit], log_ratio[outputs > limit], rng)
    scores = density.draws(size, rng)
    log_ratio, outputs = density.log_ratio(scores), solve(scores)
    runs += size
    return judged(
        scores, log_ratio, outputs, limit, (first, first_error), runs, levels,
        (solve, ray, target, confidence),
        lambda above, rows: _mean(log_ratio[rows], above[rows]),
    )  # fmt: skip


def judged(
    scores: Floats,
    log_ratio: Floats,
    outputs: Floats,
    limit: float,
    check: tuple[float, float],
    runs: int,
    levels: list[float],
    settings: tuple[Runs, int, float, float],
    mean: Mean,
) -> Estimate:
    """Return the estimate of the last sample, its verdict, and the design point."""
    solve, ray, target, confidence = settings
    above, gaps = outputs > limit, np.isnan(outputs)
    everything = np.full(gaps.shape, True)
    value, error, heaviest = mean(above, everything)
    if not above.any() or value <= 0:
        return Estimate(RareEventVerdict.NOT_REACHED, runs, levels)
    most_of, most_error, _ = mean(above | gaps, everything)
    answered = mean(above, ~gaps)[0] if gaps.any() else value
    # logarithms of the ends are symmetric: the weights are skewed, and no end is below zero
    quantile = float(scipy.stats.t.ppf(0.5 + confidence / 2, outputs.size - 1))
    low = value * np.exp(-quantile * error / value)
    high = min(1.0, most_of * np.exp(quantile * most_error / most_of))
    variation = error / value
    apart = abs(value - check[0]) / np.hypot(error, check[1])
    holds = {
        RareEventVerdict.DISAGREEING: apart > _DISAGREEING,
        RareEventVerdict.HEAVY_WEIGHT: heaviest > _HEAVY,
        RareEventVerdict.IMPRECISE: variation > 1.25 * target,
        RareEventVerdict.MISSING: bool(gaps.any()),
    }
    verdict = next((kind for kind, held in holds.items() if held), RareEventVerdict.USABLE)
    point = _design_point(scores[above], log_ratio[above], limit, solve, ray)
    return Estimate(
        verdict, runs + ray, levels, answered, low, high, value, most_of, check[0],
        variation, int(gaps.sum()), outputs.size, design_point=point,
        outputs=outputs, weights=np.exp(log_ratio),
    )  # fmt: skip


def _mean(log_ratio: Floats, above: NDArray[np.bool_]) -> tuple[float, float, float]:
    """Return the weighted share of runs above, its standard error, and the largest one's share."""
    weights = np.where(above, np.exp(log_ratio), 0.0)
    total = float(weights.sum())
    error = SAFETY * float(weights.std(ddof=1)) / np.sqrt(weights.size)
    return total / weights.size, error, float(weights.max()) / total if total else np.nan


def nearest_mixture(scores: Floats, log_ratio: Floats, rng: np.random.Generator) -> Mixture:
    """Return the mixture nearest to weighted runs, with the components that Schwarz's BIC wants."""
    weights = np.exp(log_ratio - log_ratio.max())
    weights /= weights.sum()
    effective = 1 / float((weights**2).sum())
    best, least = None, np.inf
    for size in _COMPONENTS:
        if size > 1 and size > min(effective / 3, len(np.unique(scores, axis=0))):
            break
        mixture = _of_size(size, scores, weights, rng)
        densities = scipy.special.logsumexp(mixture.components(scores), axis=0)
        free = size * (scores.shape[1] + 1) - 1
        criterion = free * np.log(effective) - 2 * effective * float((weights * densities).sum())
        if criterion < least:
            best, least = mixture, criterion
    assert best is not None  # one component is always possible
    even = _SPREAD / best.weights.size
    shares = (1 - _SPREAD) * best.weights + even
    parameters = scores.shape[1]
    reach = float(np.sqrt((best.weights[:, None] * best.means**2).sum() / parameters))
    return Mixture(
        np.append((1 - _ALL_ROUND) * shares, _ALL_ROUND),
        np.concatenate([best.means, np.zeros((1, parameters))]),
        np.append(best.widths, max(reach, _LEAST_REACH)),
    )


def _of_size(size: int, scores: Floats, weights: Floats, rng: np.random.Generator) -> Mixture:
    """Return a mixture by expectation and maximisation, from starts far from each other."""
    starts = [int(weights.argmax())]
    distance = ((scores - scores[starts[0]]) ** 2).sum(axis=1)
    while len(starts) < size:
        chance = distance * weights
        starts.append(int(rng.choice(weights.size, p=chance / chance.sum())))
        distance = np.minimum(distance, ((scores - scores[starts[-1]]) ** 2).sum(axis=1))
    widths = np.full(size, WIDTH)
    mixture = Mixture(np.full(size, 1 / size), scores[starts], widths)
    for _ in range(_ITERATIONS if size > 1 else 1):
        logarithms = mixture.components(scores)
        shares = np.exp(logarithms - scipy.special.logsumexp(logarithms, axis=0)) * weights
        sums = shares.sum(axis=1) + 1e-300
        # einsum, not a product of matrices: the same bits for any number of threads
        means = np.einsum("kn,nd->kd", shares, scores) / sums[:, None]
        mixture = Mixture(np.maximum(sums / sums.sum(), 1e-12), means, widths)
    return mixture


def _design_point(scores: Floats, log_ratio: Floats, limit: float, solve: Runs, ray: int) -> Floats:
    """Return the run beyond the limit that is nearest to the middle of all scores.

    scores, log_ratio: of runs beyond. Single runs are off by chance in parameters that do not
    matter: a run towards the mean of those around the nearest one is taken where it is as near.
    """
    lengths = np.sqrt((scores**2).sum(axis=1))
    nearest = scores[lengths.argmin()]
    around = (scores * nearest).sum(axis=1) >= _AROUND * lengths * lengths.min()
    weights = np.exp(log_ratio - log_ratio.max()) * around
    middle = (weights[:, None] * scores).sum(axis=0) / weights.sum()
    along = np.linspace(0.7, 1.1, ray)[:, None] * middle
    beyond = along[solve(along) > limit]
    length = np.sqrt((beyond**2).sum(axis=1)).min(initial=np.inf)
    return np.asarray(beyond[0] if length <= _AS_NEAR * lengths.min() else nearest)
