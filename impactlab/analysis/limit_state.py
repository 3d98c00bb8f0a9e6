"""Probability beyond a limit from few runs, which a Gaussian process of the response places.

Parameters are standard normal scores. Batch by batch, runs are placed where the process, fitted to
the runs before, leaves most of the estimate's variance: where it does not know on which side of the
limit a run lies. It is the learning function of AK-MCS (Echard, Gayton and Lemaire 2011, Struct.
Saf. 33, 145), weighted by what a mistake there costs.

The process only steers. The estimate is the probability by the process plus the mean difference of
true runs from it, over a last sample whose density and size the runs before have chosen: a control
variate, unbiased whatever the process predicts, to which stopping adds no error. It is importance
sampling with a surrogate as in Dubourg, Sudret and Deheeger (2013), Probab. Eng. Mech. 33, 47.
All of these are recalled, not read.
"""

import warnings
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy  # its stats and special are loaded when first used
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.rare_event import (
    SAFETY,
    SHARE,
    Estimate,
    Mixture,
    RareEventVerdict,
    Runs,
    judged,
    nearest_mixture,
)
from impactlab.types import Floats

MOST_PARAMETERS = 16
_BATCH = 8  # whatever the number of workers
_FEWEST, _CHECKS = 100, 60  # runs of the last sample, at least, and of the one before
_LEARNING = 240  # runs that are placed, at most
_PILOT, _PER_PARAMETER, _PILOT_SPREAD = 16, 3, 1.5  # runs, at least; standard deviations of scores
_FEWEST_ANSWERS = 5
_CANDIDATES, _SHORTLIST, _DRAWS = 2000, 200, 10_000
_LEVEL, _LEVELS = 600, 40  # draws of the process, per level, and levels at most
_OPTIMISM = 1.0  # standard deviations of the process by which the limit may be nearer
_UNLIKELY = 1e-4  # probability to lie beyond the limit that a density does without
_RAY, _STRIDE = 401, 4  # points of a ray towards the design point, and between its runs
_MARGIN = 1.2  # on the size of the last sample
_NEAR = 0.3  # of the process' probability, below which that of the checks does not count


@dataclass(frozen=True)
class Process:
    """A Gaussian process of (response - limit) over scores, in units of the response's scatter.

    regressor: scikit-learn's, to values without their mean. shift: their mean.
    """

    regressor: Any
    shift: float

    def mean_and_deviation(self, scores: Floats) -> tuple[Floats, Floats]:
        """Return the distance from the limit, and its standard deviation, (runs,)."""
        mean, deviation = self.regressor.predict(scores, return_std=True)
        return mean + self.shift, np.maximum(deviation, 1e-9)

    def covariance(self, scores: Floats) -> Floats:
        """Return the covariance of the distances, (runs, runs)."""
        return np.asarray(self.regressor.predict(scores, return_cov=True)[1])

    def probability(self, scores: Floats) -> Floats:
        """Return the probability that a run lies beyond the limit, (runs,)."""
        mean, deviation = self.mean_and_deviation(scores)
        return np.asarray(scipy.special.ndtr(mean / deviation))


def process(scores: Floats, outputs: Floats, limit: float, before: Process | None) -> Process:
    """Return a process fitted to the runs that answered; its search begins at the one before."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    answered = np.isfinite(outputs)
    values = outputs[answered]
    centre, scale = float(values.mean()), float(values.std()) or 1.0
    if before is None:
        smooth = Matern(np.full(scores.shape[1], 3.0), (0.3, 100.0), nu=2.5)
        noise = WhiteKernel(1e-6, (1e-9, 1.0))
        kernel = ConstantKernel(10.0, (0.1, 1e5)) * smooth + noise
    else:
        kernel = before.regressor.kernel_
    regressor = GaussianProcessRegressor(kernel)
    with warnings.catch_warnings():  # bounds are reached on purpose: a parameter does not matter
        warnings.simplefilter("ignore", ConvergenceWarning)
        regressor.fit(scores[answered], (values - centre) / scale)
    return Process(regressor, (centre - limit) / scale)


@threadpool_limits.wrap(limits=1)  # type: ignore[untyped-decorator]
def learned_estimate(
    solve: Runs,
    parameters: int,
    limit: float,
    *,
    seed: int,
    most: int,
    target: float,
    confidence: float,
) -> Estimate:
    """Return the probability that a response exceeds a limit, from runs that a process places.

    Arguments are those of rare_event.estimate. One thread of linear algebra gives the same bits on
    any number of processors.
    """
    rng = np.random.default_rng(seed)
    scores = _pilot(parameters, rng)
    outputs = solve(scores)
    fit: Process | None = None
    enough, placed = 0, min(_LEARNING, most // 2)
    while np.isfinite(outputs).sum() >= _FEWEST_ANSWERS:
        fit = process(scores, outputs, limit, fit)
        density = _density(fit, parameters, rng)
        candidates = density.draws(_CANDIDATES, rng)
        weights = np.exp(density.log_ratio(candidates))
        enough = enough + 1 if _size(fit, candidates, weights, target) <= _FEWEST else 0
        if enough == 2 or outputs.size + _BATCH > placed:
            break
        batch = _batch(fit, candidates, weights, scores[np.isnan(outputs)])
        scores, outputs = np.concatenate([scores, batch]), np.append(outputs, solve(batch))
    runs = outputs.size
    if fit is None:
        return Estimate(RareEventVerdict.NOT_REACHED, runs, [])
    sample = _Sample.of(fit, density, _CHECKS, limit, solve, rng)
    (first, error, _), runs = sample.mean(sample.outputs > limit), runs + _CHECKS
    if not (sample.outputs > limit).any():
        return Estimate(RareEventVerdict.NOT_REACHED, runs, [])
    goal = target * max(first, _NEAR * sample.expected)
    size = int(np.ceil(_MARGIN * _CHECKS * (error / goal) ** 2))
    scores, outputs = np.concatenate([scores, sample.scores]), np.append(outputs, sample.outputs)
    fit = process(scores, outputs, limit, fit)
    density = _density(fit, parameters, rng)
    size = min(max(size, _FEWEST), most - runs - _BATCH)
    sample = _Sample.of(fit, density, size, limit, solve, rng)

    def confirm(ray: Floats) -> Floats:
        """Return responses along a ray where the process expects the limit, -inf elsewhere."""
        place = int((fit.mean_and_deviation(ray)[0] > 0).argmax())
        rows = np.clip(place + _STRIDE * np.arange(-2, _BATCH - 2), 0, len(ray) - 1)
        confirmed = np.full(len(ray), -np.inf)
        confirmed[rows] = solve(ray[rows])
        return confirmed

    result = judged(
        sample.scores, sample.log_ratio, sample.outputs, limit, (first, error), 0, [],
        (confirm, _RAY, target, confidence), sample.mean,
    )  # fmt: skip
    runs += size + (0 if result.design_point is None else _BATCH)
    return replace(result, placed=outputs.size - _CHECKS, runs=runs)


@dataclass(frozen=True)
class _Sample:
    """Runs of a density, with what the process predicts of them.

    predicted: probability of each to lie beyond the limit. expected: probability by the process
    alone, variance: of its mean over draws. largest: weight that a run beyond the limit has.
    """

    scores: Floats
    log_ratio: Floats
    outputs: Floats
    predicted: Floats
    expected: float
    variance: float
    largest: float

    @classmethod
    def of(
        cls,
        fit: Process,
        density: Mixture,
        size: int,
        limit: float,
        solve: Runs,
        rng: np.random.Generator,
    ) -> "_Sample":
        """Draw and solve a sample."""
        scores, draws = density.draws(size, rng), density.draws(_DRAWS, rng)
        weights = np.exp(density.log_ratio(draws))
        shares = weights * fit.probability(draws)
        expected = float(shares.mean())
        return cls(
            scores, density.log_ratio(scores), solve(scores), fit.probability(scores),
            expected, float(shares.var()) / _DRAWS,
            float((weights * shares).mean()) / max(expected, 1e-300),
        )  # fmt: skip

    def mean(
        self, above: NDArray[np.bool_], rows: NDArray[np.bool_] | slice = slice(None)
    ) -> tuple[float, float, float]:
        """Return the probability, its standard error, and the largest share of a run's difference.

        The error holds one more run on the wrong side: a sample without any does not show that
        there are none.
        """
        weights = np.exp(self.log_ratio[rows])
        differences = weights * (above[rows] - self.predicted[rows])
        size = differences.size
        value = self.expected + float(differences.mean())
        square = SAFETY**2 * float(differences.var(ddof=1)) / size + self.variance
        error = float(np.sqrt(square + (self.largest / size) ** 2))
        heaviest = float(np.abs(differences).max()) / size
        return value, error, heaviest / value if value > 0 else np.nan


def _pilot(parameters: int, rng: np.random.Generator) -> Floats:
    """Return the first scores, spread over more than those of the parameters."""
    runs = max(_PILOT, _PER_PARAMETER * (parameters + 1))
    unit = scipy.stats.qmc.Sobol(parameters, rng=rng).random(1 << (runs - 1).bit_length())
    return np.asarray(_PILOT_SPREAD * scipy.special.ndtri(np.clip(unit, 1e-9, 1 - 1e-9)))


def _density(fit: Process, parameters: int, rng: np.random.Generator) -> Mixture:
    """Return a density about the runs that may lie beyond the limit, from draws of the process.

    Level by level as in rare_event; where no draw reaches the limit, it lies about those nearest.
    """
    scores, log_ratio = rng.standard_normal((_LEVEL, parameters)), np.zeros(_LEVEL)
    for _ in range(_LEVELS):
        mean, deviation = fit.mean_and_deviation(scores)
        nearness = mean + _OPTIMISM * deviation
        level = float(np.quantile(nearness, 1 - SHARE, method="lower"))
        if level >= 0:
            break
        beyond = nearness >= level
        density = nearest_mixture(scores[beyond], log_ratio[beyond], rng)
        scores = density.draws(_LEVEL, rng)
        log_ratio = density.log_ratio(scores)
    mean, deviation = fit.mean_and_deviation(scores)
    likely = scipy.special.ndtr(mean / deviation)
    beyond = (likely > _UNLIKELY) | (mean + _OPTIMISM * deviation >= min(level, 0.0))
    # the density of least variance, if the process is right: of the square root
    best = log_ratio + 0.5 * np.log(np.maximum(likely, 1e-8))
    return nearest_mixture(scores[beyond], best[beyond], rng)


def _size(fit: Process, candidates: Floats, weights: Floats, target: float) -> float:
    """Return how many runs give the target, if the process is right."""
    likely = fit.probability(candidates)
    probability = float((weights * likely).mean())
    variance = float((weights**2 * likely * (1 - likely)).mean())
    return _MARGIN * variance / max(target * probability, 1e-150) ** 2


def _batch(fit: Process, candidates: Floats, weights: Floats, failed: Floats) -> Floats:
    """Return the candidates that leave most of the variance, one after the other.

    Each is chosen as if those before had answered as predicted, and so had failed runs: near them
    there is little left to learn, and no more runs are placed.
    """
    likely = fit.probability(candidates)
    gains = weights**2 * likely * (1 - likely)
    best = np.argsort(-gains, kind="stable")[:_SHORTLIST]
    mean, squares = fit.mean_and_deviation(candidates[best])[0], weights[best] ** 2
    covariance = fit.covariance(np.concatenate([candidates[best], failed[-_SHORTLIST:]]))
    variance = np.maximum(np.diag(covariance)[: best.size], 1e-18)
    chosen: list[int] = []
    rows = list(range(best.size, len(covariance)))
    for _ in range(len(rows) + _BATCH):
        if rows:
            row = rows.pop()
        else:
            left = np.maximum(np.diag(covariance)[: best.size], 1e-18)
            likely = scipy.special.ndtr(mean / np.sqrt(left))
            gains = squares * likely * (1 - likely) * left / variance
            gains[chosen] = -1.0
            row = int(gains.argmax())
            chosen.append(row)
        column = covariance[:, row]
        covariance = covariance - np.outer(column, column) / (column[row] + 1e-9)
    return np.asarray(candidates[best[chosen]])
