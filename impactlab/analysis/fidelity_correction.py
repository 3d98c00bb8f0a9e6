"""Answers of a slow model at stated inputs, from the fast model's there and pairs of both.

The slow model is a line in the fast one and a rest, which is a Gaussian process over the inputs and
the fast output: Kennedy and O'Hagan (2000), Biometrika 87, 1; Perdikaris and others (2017), Proc.
R. Soc. A 473, 20160751. Intervals are those of the jackknife+ (Barber and others 2021, Ann. Stat.
49, 486): line and process are fitted again without each pair, and how far they miss it, over the
standard deviation that they state, tells how wide an interval is. A process that fits badly thus
widens intervals. All of these are recalled, not read.
"""

import warnings
from dataclasses import dataclass
from importlib.util import find_spec
from math import ceil, floor
from typing import Any, Self

import numpy as np
from threadpoolctl import threadpool_limits

from impactlab.analysis.fidelity_estimates import FidelityPrediction
from impactlab.analysis.multifidelity_distribution import line_through, spread
from impactlab.types import Floats

_FOLDS = 10  # of pairs, without which the process's lengths are fitted
_OUTER = 0.05  # share of the pairs on either side of an input beyond which a point is outer
_SAFETY = 1.5  # factor of the greatest miss at outer points, where misses grow
_ROUNDING = 1e-9


@dataclass(frozen=True)
class _Fit:
    """A line through pairs, and a process of the rest. scale: deviation about the line.

    regressor: scikit-learn's, over inputs and fast output, of the rest in units of the scale.
    """

    low: Floats
    high: Floats
    regressor: Any
    scale: float

    @classmethod
    def of(cls, inputs: Floats, low: Floats, high: Floats, kernel: Any, *, moves: bool) -> Self:
        """Return the fit to pairs. moves: True to search the kernel's lengths and amplitudes."""
        from sklearn.gaussian_process import GaussianProcessRegressor

        _, _, rest = line_through(low, high, low)
        scale = spread(rest) or 1.0
        regressor = GaussianProcessRegressor(kernel, optimizer="fmin_l_bfgs_b" if moves else None)
        return cls(low, high, regressor.fit(inputs, rest / scale), scale)

    def prediction(self, inputs: Floats, low: Floats) -> tuple[Floats, Floats]:
        """Return the slow output and its standard deviation, with the line's own error."""
        _, line, _ = line_through(self.low, self.high, low)
        mean, deviation = self.regressor.predict(inputs, return_std=True)
        about = self.low - self.low.mean()
        leverage = 1 / about.size + (low - self.low.mean()) ** 2 / (about @ about)
        return line + self.scale * mean, self.scale * np.sqrt(deviation**2 + leverage)


def check_pairs(owner: str, pairs: int, confidence: float) -> None:
    """Raise ValueError for too few pairs, OSError where scikit-learn is not installed."""
    if find_spec("sklearn") is None:
        raise OSError(f"{owner}: needs scikit-learn: pip install 'impactlab[kriging]'")
    fewest = ceil(confidence / (1.0 - confidence) - _ROUNDING)
    if pairs < fewest:
        raise ValueError(
            f"{owner}: a {100 * confidence:g} % interval needs {fewest} pairs, and there are "
            f"{pairs}: add pairs, or lower the confidence"
        )


def outside(inputs: Floats, points: Floats) -> list[list[int]]:
    """Return the columns in which each point lies beyond all pairs."""
    beyond = ~((points >= inputs.min(axis=0)) & (points <= inputs.max(axis=0)))
    return [np.flatnonzero(row).tolist() for row in beyond]


def predicted(
    owner: str,
    inputs: Floats,
    low: Floats,
    high: Floats,
    points: Floats,
    fast: Floats,
    confidence: float,
) -> FidelityPrediction:
    """Return predictions at points, and the reason where there is none; see `corrected`.

    low: of all runs. Raises as check_pairs.
    """
    check_pairs(owner, high.size, confidence)
    pairs = low[: high.size]
    columns = outside(np.column_stack([inputs, pairs]), np.column_stack([points, fast]))
    inner = [row for row, beyond in enumerate(columns) if not beyond]
    ends = np.full((len(points), 3), np.nan)
    if inner:
        ends[inner] = corrected(inputs, pairs, high, points[inner], fast[inner], confidence)
    names = [f"parameter {number + 1}" for number in range(inputs.shape[1])] + ["the fast output"]
    refusal = [
        f"{names[beyond[0]]} is beyond those of the pairs" if beyond else "" for beyond in columns
    ]
    return FidelityPrediction(ends[:, 0], ends[:, 1], ends[:, 2], refusal)


@threadpool_limits.wrap(limits=1)  # type: ignore[untyped-decorator]
def corrected(
    inputs: Floats, low: Floats, high: Floats, points: Floats, fast: Floats, confidence: float
) -> Floats:
    """Return predictions and ends of their intervals, (points, 3).

    inputs, low, high: of the pairs, (pairs, inputs) and (pairs,). points: inputs, (points, inputs).
    fast: the fast model's outputs there. One thread of linear algebra gives the same bits on any
    number of processors.
    """
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    pairs = high.size
    columns, places = np.column_stack([inputs, low]), np.column_stack([points, fast])
    centre, width = columns.mean(axis=0), columns.std(axis=0)
    width[width == 0.0] = 1.0
    columns, places = (columns - centre) / width, (places - centre) / width
    smooth = Matern(np.full(columns.shape[1], 2.0), (0.1, 100.0), nu=2.5)
    start = ConstantKernel(1.0, (1e-3, 1e3)) * smooth + WhiteKernel(0.1, (1e-8, 3.0))
    folds = np.arange(pairs) % _FOLDS
    ends = np.empty((2, pairs, len(places)))

    def fitted(rows: Any, kernel: Any, *, moves: bool) -> _Fit:
        return _Fit.of(columns[rows], low[rows], high[rows], kernel, moves=moves)

    with warnings.catch_warnings():  # bounds are reached on purpose: an input does not matter
        warnings.simplefilter("ignore", ConvergenceWarning)
        every = fitted(slice(None), start, moves=True)
        kernel = every.regressor.kernel_
        kernels = [
            fitted(folds != fold, kernel, moves=True).regressor.kernel_ for fold in range(_FOLDS)
        ]
    safety = np.where(outer := _outer(columns, places), _SAFETY, 1.0)
    for pair in range(pairs):
        fit = fitted(np.arange(pairs) != pair, kernels[folds[pair]], moves=False)
        expected, deviation = fit.prediction(columns[[pair]], low[[pair]])
        miss = np.abs(high[pair] - expected) / deviation
        expected, deviation = fit.prediction(places, fast)
        margin = safety * miss * deviation
        ends[:, pair] = expected - margin, expected + margin
    ends.sort(axis=1)
    most = ceil(confidence * (pairs + 1) - _ROUNDING)
    least = floor((1.0 - confidence) * (pairs + 1) + _ROUNDING)
    lows = np.where(outer, ends[0, 0], ends[0, least - 1])
    highs = np.where(outer, ends[1, -1], ends[1, most - 1])
    value = every.prediction(places, fast)[0]
    return np.column_stack([value, np.minimum(lows, value), np.maximum(highs, value)])


def _outer(columns: Floats, places: Floats) -> Any:
    """Return True for places beyond most pairs in any column."""
    tails = np.quantile(columns, [_OUTER, 1.0 - _OUTER], axis=0)
    return ((places < tails[0]) | (places > tails[1])).any(axis=1)
