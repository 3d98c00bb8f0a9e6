"""The best design whose probability of exceeding a limit is small enough.

Design variables lie in a unit cube, scatter in standard normal scores. A quadratic, fitted to runs
over both, gives the mean and the standard deviation of the response at any design, and so a first
guess of its reliability index -Φ⁻¹(P). Estimates by importance sampling at a few designs correct
the guess: their difference from it is interpolated with its uncertainty (kriging; Sacks and others
1989, Stat. Sci. 4, 409; recalled, not read). Each estimate is made at the best design so far.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy  # its stats and special are loaded when first used
from threadpoolctl import threadpool_limits

from impactlab.analysis.rare_event import SHARE, Estimate, estimate
from impactlab.types import Floats
from impactlab.verdicts import Verdict

MOST_VARIABLES = 2
MOST_ESTIMATES = 10
_TERMS = 4  # pilot runs per term of the quadratic
_FEWEST_PILOT_RUNS = 200
_PILOT_SPREAD = 1.5  # standard deviations of the pilot's scores: the limit lies in the tails
_SHIFT, _SCALE, _BEND, _LENGTH = 2.0, 1.0, 2.0, 0.4
"""Standard deviations of the difference: one for all designs, one per unit of the first guess, one
that varies over designs, and over which share of the ranges it does."""
_POINTS = {1: 201, 2: 41}  # of a grid, per design variable
_ZOOMS, _ZOOM = 6, 0.2
_SAME = 1e-3  # share of a range within which two designs are one
_AIM, _TOO_SAFE = 1.2, 1.0
"""Distance of the index aimed at from the goal, over half the width of its interval, so that all of
this is beyond the goal; distance beyond which a better design is looked for, over that."""
_UNREACHED = 1.0  # by which an index too large to estimate is taken to lie beyond the goal
_ENDS = 0.01  # share of a range within which a design lies at its end
FRONT = 10.0
"""Ratio of the ends of the front to the probability wanted."""
_FRONT_POINTS, _LIKELY = 21, 0.4  # points, and greatest probability, of the front
Response = Callable[[Floats, Floats], Floats]
Index = Callable[[Floats], Floats]


class SizingVerdict(Verdict):
    """Verdicts on a design; from IMPOSSIBLE on, it does not meet the probability."""

    USABLE = True, "runs at the design confirm its probability"
    AT_END = True, "runs confirm the best end of the ranges: wider ones may hold a better design"
    NUMERICAL = (
        False,
        "the numerical error may lift the probability above the one wanted: take a finer "
        "discretisation",
    )
    UNREACHED = False, "even the best end of the ranges hardly reaches the limit: no run there did"
    UNSOUND = False, "the probability at the design is not to be relied on"
    NOT_CONVERGED = False, "no estimate allowed meets the probability: allow more runs"
    IMPOSSIBLE = False, "no design in the ranges has so small a probability"


@dataclass(frozen=True)
class Sizing:
    """A design with its probability, and others around it.

    designs: in the unit cube, (3, variable): the one chosen, of which the whole interval of the
    probability is small enough, and the ends between which the best one lies, NaN where there is
    none. objectives: theirs, (3,). probability: of the chosen one, by runs there. estimates,
    tried, tried_objectives: of all designs that were tried, (estimate, variable). front:
    probabilities, objectives, and their lower and upper ends, (4, point). runs: number of all.
    """

    verdict: SizingVerdict
    designs: Floats
    objectives: Floats
    probability: Estimate
    estimates: list[Estimate]
    tried: Floats
    tried_objectives: Floats
    front: Floats
    runs: int


@dataclass
class _Model:
    """Reliability index over designs: a first guess, and estimates that correct it.

    guess: index from designs (designs, variable). errors: standard errors of the indices.
    """

    guess: Index
    designs: list[Floats] = field(default_factory=list)
    indices: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)

    def __call__(self, designs: Floats) -> Floats:
        """Return the index at designs (design, variable)."""
        return self.mean_and_deviation(designs)[0]

    def mean_and_deviation(self, designs: Floats) -> tuple[Floats, Floats]:
        """Return the index, and the standard deviation of what is not known of it."""
        guesses = self.guess(designs)
        variance = _SHIFT**2 + (_SCALE * guesses) ** 2 + _BEND**2
        if not self.designs:
            return guesses, np.sqrt(variance)
        tried = np.array(self.designs)
        guessed = self.guess(tried)
        across = _covariance(designs, tried, guesses, guessed)
        noise = np.diag(np.square(self.errors))
        factor = scipy.linalg.cho_factor(_covariance(tried, tried, guessed, guessed) + noise)
        mean = guesses + across @ scipy.linalg.cho_solve(factor, np.array(self.indices) - guessed)
        variance -= np.einsum("ij,ji->i", across, scipy.linalg.cho_solve(factor, across.T))
        return mean, np.sqrt(np.maximum(variance, 0.0))

    def add(self, design: Floats, index: float, error: float) -> None:
        """Add an estimate at a design, (variable,)."""
        self.designs.append(design)
        self.indices.append(index)
        self.errors.append(error)


def _covariance(first: Floats, second: Floats, guesses: Floats, others: Floats) -> Floats:
    """Return the covariance of the difference between two sets of designs."""
    squares = ((first[:, None] - second) ** 2).sum(axis=-1)
    bend = _BEND**2 * np.exp(-0.5 * squares / _LENGTH**2)
    return np.asarray(_SHIFT**2 + _SCALE**2 * np.outer(guesses, others) + bend)


@threadpool_limits.wrap(limits=1)  # type: ignore[untyped-decorator]
def size(
    solve: Response,
    objective: Index,
    variables: int,
    parameters: int,
    limit: float,
    probability: float,
    *,
    seed: int,
    samples: int,
    runs: int,
    target: float,
    confidence: float,
) -> Sizing:
    """Return the design of least objective whose probability is at most the one stated.

    solve: from designs in the unit cube (runs, variable) and standard normal scores (runs,
    parameter) to the response, (runs,), NaN where it is missing. objective: of designs. samples,
    runs, target: of each estimate (impactlab.analysis.rare_event). One thread of linear algebra
    gives the same bits on any number of processors.
    """
    goal, quantile = -scipy.special.ndtri(probability), scipy.special.ndtri(0.5 + confidence / 2)
    pilot, guess = _first_guess(solve, variables, parameters, limit, seed)
    model, estimates, solved = _Model(guess), list[Estimate](), pilot

    def tried(design: Floats) -> float:
        """Add an estimate at a design; return the unfavourable end of its index."""
        nonlocal solved
        result = estimate(
            lambda scores: solve(np.tile(design, (len(scores), 1)), scores),
            parameters, limit, seed=seed + 1 + len(estimates),
            samples=samples, most=runs, target=target, confidence=confidence,
        )  # fmt: skip
        estimates.append(result)
        solved += result.runs
        model.add(design, *_index(result, goal, quantile))
        return float(model.indices[-1] - quantile * model.errors[-1])

    margin = target * probability / _density(goal)
    while len(estimates) < MOST_ESTIMATES - 2:
        margin = max([margin, *model.errors[-1:]])  # wider where runs are missing
        reach = _AIM * quantile * margin
        best = _best(objective, model, goal + reach, variables)
        if best is None:
            best, most = _safest(model, variables, quantile)
            if estimates and most < goal:
                break
        repeated = any(np.abs(best - design).max() < _SAME for design in model.designs)
        if repeated or goal <= tried(best) <= goal + (1 + _TOO_SAFE) * reach:
            break
        if _is_least(best, objective, variables) and _is_far(estimates[-1], probability):
            same, tries = np.tile(best, (3, 1)), np.array(model.designs)
            return Sizing(
                SizingVerdict.UNREACHED, same, objective(same), estimates[-1], estimates,
                tries, objective(tries), np.empty((4, 0)), solved,
            )  # fmt: skip
    chosen = len(estimates) - 1
    verdict = _verdict(model, estimates[chosen], goal, quantile)
    if verdict > SizingVerdict.UNSOUND:
        chosen = int(np.argmax(model.indices))
    for ratio in (FRONT, 1 / FRONT):
        index = -scipy.special.ndtri(min(_LIKELY, ratio * probability))
        end = _best(objective, model, index, variables)
        if end is not None and verdict.sound:
            tried(end)
    design = model.designs[chosen]
    margin = quantile * float(model.mean_and_deviation(design[np.newaxis])[1][0])
    ends = [_best(objective, model, goal + side, variables) for side in (-margin, margin)]
    designs = [design, *(np.full(variables, np.nan) if end is None else end for end in ends)]
    objectives = [
        np.nan if np.isnan(row).any() else objective(row[np.newaxis])[0] for row in designs
    ]
    front = _front(objective, model, probability, quantile, variables)
    return Sizing(
        verdict, np.array(designs), np.array(objectives), estimates[chosen], estimates,
        np.array(model.designs), objective(np.array(model.designs)), front, solved,
    )  # fmt: skip


def pilot_runs(size: int) -> int:
    """Return the number of runs that give the first guess, of so many variables and parameters."""
    return int(1 << (max(_FEWEST_PILOT_RUNS, _TERMS * _terms(size)) - 1).bit_length())


def _terms(size: int) -> int:
    return (size + 1) * (size + 2) // 2


def _first_guess(
    solve: Response, variables: int, parameters: int, limit: float, seed: int
) -> tuple[int, Index]:
    """Return the number of pilot runs, and the index by mean and deviation of their quadratic.

    Raises ValueError where too few of them have an answer.
    """
    size = variables + parameters
    terms, runs = _terms(size), pilot_runs(size)
    unit = scipy.stats.qmc.Sobol(size, rng=np.random.default_rng(seed)).random(runs)
    designs = unit[:, :variables]
    scores = _PILOT_SPREAD * scipy.special.ndtri(np.clip(unit[:, variables:], 1e-9, 1 - 1e-9))
    outputs = solve(designs, scores)
    answered = np.isfinite(outputs)
    if answered.sum() < 2 * terms:
        raise ValueError(f"{answered.sum()} of {runs} pilot runs have an answer: too few to begin")
    rows, columns = np.triu_indices(size + 1)

    def basis(designs: Floats, scores: Floats) -> Floats:
        one = np.ones((len(designs), 1))
        inputs = np.concatenate([one, 2 * designs - 1, scores], axis=1)
        return np.asarray(inputs[:, rows] * inputs[:, columns])

    table = basis(designs, scores)[answered]
    coefficients, *_ = scipy.linalg.lstsq(table, outputs[answered])
    square = np.zeros((size + 1, size + 1))
    square[rows, columns] = 0.5 * coefficients
    square = square + square.T
    curved = square[variables + 1 :, variables + 1 :]

    def guess(designs: Floats) -> Floats:
        fixed = np.concatenate([np.ones((len(designs), 1)), 2 * designs - 1], axis=1)
        slopes = 2 * fixed @ square[: variables + 1, variables + 1 :]
        mean = np.einsum("ni,ij,nj->n", fixed, square[: variables + 1, : variables + 1], fixed)
        variance = (slopes**2).sum(axis=1) + 2 * (curved**2).sum()
        return np.asarray((limit - mean - np.trace(curved)) / np.sqrt(variance + 1e-300))

    return runs, guess


def _index(result: Estimate, goal: float, quantile: float) -> tuple[float, float]:
    """Return the reliability index of an estimate, and its standard error."""
    if np.isnan(result.probability):  # too small for the runs allowed
        return goal + _UNREACHED, _UNREACHED
    high, low = -scipy.special.ndtri(np.clip([result.low, result.high], 1e-300, 1 - 1e-6))
    error = max(high - low, 1e-9) / (2 * quantile)
    return float(0.5 * (low + high)), float(error if result.verdict.sound else 3 * error)


def _best(objective: Index, index: Index, goal: float, variables: int) -> Floats | None:
    """Return the design of least objective whose index reaches the goal, None if there is none."""
    low, high = np.zeros(variables), np.ones(variables)
    best: Floats | None = None
    for _ in range(_ZOOMS):
        designs = _grid(low, high)
        if best is not None:
            designs = np.concatenate([best[np.newaxis], designs])
        indices = index(designs)
        objectives = np.where(indices >= goal, objective(designs), np.inf)
        if not np.isfinite(objectives).any():
            return None
        least = objectives <= objectives.min() * (1 + np.sign(objectives.min()) * 1e-12)
        best = designs[np.where(least, indices, -np.inf).argmax()]  # of equals, the safest
        reach = _ZOOM * (high - low)
        low, high = np.maximum(best - reach, 0.0), np.minimum(best + reach, 1.0)
    return best


def _is_least(design: Floats, objective: Index, variables: int) -> bool:
    """Return True where no design has a smaller objective."""
    least = _best(objective, lambda designs: np.ones(len(designs)), 0.0, variables)
    return least is not None and bool(objective(design[None])[0] <= objective(least[None])[0])


def _is_far(result: Estimate, probability: float) -> bool:
    """Return True where the search for the limit ended in runs far rarer than the probability.

    That is a tenth of it; or the response rose no more, level after level.
    """
    levels = result.levels
    if not np.isnan(result.probability) or not np.isfinite(levels[-1]):
        return False
    is_still = len(levels) > 2 and levels[-1] <= levels[-3]
    return is_still or SHARE ** len(levels) <= 0.1 * probability


def _safest(model: _Model, variables: int, quantile: float) -> tuple[Floats, float]:
    """Return the design whose index may be the largest, and the upper end of its interval."""
    designs = _grid(np.zeros(variables), np.ones(variables))
    mean, deviation = model.mean_and_deviation(designs)
    ends = mean + quantile * deviation
    return np.asarray(designs[ends.argmax()]), float(ends.max())


def _grid(low: Floats, high: Floats) -> Floats:
    """Return the points of a grid between two corners, (point, variable)."""
    axes = [np.linspace(*ends, _POINTS[low.size]) for ends in zip(low, high, strict=True)]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)


def _verdict(model: _Model, result: Estimate, goal: float, quantile: float) -> SizingVerdict:
    """Return the verdict on the last design of a model, of which `result` is the estimate."""
    design, index, margin = model.designs[-1], model.indices[-1], quantile * model.errors[-1]
    at_end = bool((np.minimum(design, 1 - design) < _ENDS).any())
    if index - margin < goal:
        most = _safest(model, design.size, quantile)[1]
        return SizingVerdict.IMPOSSIBLE if most < goal else SizingVerdict.NOT_CONVERGED
    if not result.verdict.sound:
        return SizingVerdict.UNSOUND
    return SizingVerdict.AT_END if at_end else SizingVerdict.USABLE


def _density(index: float) -> float:
    """Return the standard normal density."""
    return float(np.exp(-0.5 * index**2) / np.sqrt(2 * np.pi))


def _front(
    objective: Index, model: _Model, probability: float, quantile: float, variables: int
) -> Floats:
    """Return probabilities within the estimates, and the least objective for each, (4, point).

    The last two rows are its lower and upper end.
    """
    probabilities = np.geomspace(
        min(_LIKELY, FRONT * probability), probability / FRONT, _FRONT_POINTS
    )
    indices = -scipy.special.ndtri(probabilities)
    inside = (indices >= min(model.indices) - 0.05) & (indices <= max(model.indices) + 0.05)
    rows = []
    for index, share in zip(indices[inside], probabilities[inside], strict=True):
        row, best, margin = [share], _best(objective, model, index, variables), 0.0
        if best is not None:
            margin = quantile * float(model.mean_and_deviation(best[np.newaxis])[1][0])
        for target in (index, index - margin, index + margin):
            best = _best(objective, model, target, variables)
            row.append(np.nan if best is None else float(objective(best[np.newaxis])[0]))
        rows.append(row)
    return np.array(rows).reshape(-1, 4).T
