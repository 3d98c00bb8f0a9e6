"""A sparse polynomial chaos from runs: least angle regression picks the terms, least squares fits.

Hybrid least angle regression: Blatman and Sudret (2011), J. Comput. Phys. 230, 2345, section 4.3.
Least angle regression itself is scikit-learn's.
"""

from __future__ import annotations

import warnings

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.surrogate.chaos import Array, Chaos, basis
from impactlab.analysis.surrogate.terms import candidates

MOST_RUNS = 20_000
"""Runs that a fit uses; of more, it draws as many."""
_MOST_CANDIDATES = 400
_MOST_TERMS = 200
_HIGHEST_DEGREE = 20
_SMALLEST = 1e-12
"""Leverage that is left to a run at least, so that nothing is divided by zero."""


def fewest_runs(parameters: int) -> int:
    """How many runs a fit needs: four for each term of the linear model."""
    return 4 * (parameters + 1)


def drawn(runs: int, seed: int) -> NDArray[np.int64]:
    """Positions of the runs that a fit uses, rising: all, or a draw of MOST_RUNS."""
    return np.sort(np.random.default_rng(seed).permutation(runs)[:MOST_RUNS])


def fit(unit: Array, values: Array, seed: int) -> Chaos:
    """A chaos that predicts `values` from points of the unit cube.

    unit: (runs, parameters), the probabilities of the parameters' values; values: (runs,), finite.
    seed: which runs are used where there are more than MOST_RUNS. Raises ValueError when there
    are fewer than `fewest_runs`.
    """
    if len(values) < fewest_runs(unit.shape[1]):
        raise ValueError(
            f"{len(values)} runs are too few for a surrogate in {unit.shape[1]} parameters: "
            f"it needs {fewest_runs(unit.shape[1])}"
        )
    rows = drawn(len(values), seed)
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        return _fitted(unit[rows], values[rows])


def _fitted(unit: Array, values: Array) -> Chaos:
    degrees = candidates(
        unit.shape[1], min(_MOST_CANDIDATES, len(values) // 2), _highest_degree(unit)
    )
    columns, mean = basis(unit, degrees), values.mean()
    order = _order(columns, values - mean)
    coefficients = _least_squares(columns[order], values - mean)
    coefficients[0] += mean
    return Chaos(degrees[order[: coefficients.size]], coefficients)


def _highest_degree(unit: Array) -> int:
    """What the parameter with the fewest levels can tell apart."""
    levels = min(np.unique(np.round(column, 9)).size for column in unit.T)
    return min(_HIGHEST_DEGREE, levels - 1)


def _order(columns: Array, values: Array) -> list[int]:
    """The terms in the order in which least angle regression takes them, the constant first.

    values: of mean zero.
    """
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.linear_model import lars_path_gram  # takes a second

    centred = columns[1:] - columns[1:].mean(axis=1, keepdims=True)
    centred /= np.linalg.norm(centred, axis=1, keepdims=True)
    # Of norm one as the terms are: its tolerances are absolute.
    correlation = centred @ (values / (np.linalg.norm(values) or 1.0))
    with warnings.catch_warnings():
        # Terms that the runs cannot tell apart: it drops one of them, as it should.
        warnings.simplefilter("ignore", ConvergenceWarning)
        _, active, _ = lars_path_gram(
            correlation,
            centred @ centred.T,
            n_samples=1,
            max_iter=min(_MOST_TERMS, len(values) // 4),
        )
    return [0, *(int(term) + 1 for term in active)]


def _least_squares(columns: Array, values: Array) -> Array:
    """The coefficients of as many terms, from the first, as predict best.

    Best: the least leave-one-out error, which one QR decomposition gives for all counts at once,
    corrected for the number of terms k of n runs by (n + k)/(n - k): Blatman and Sudret (2011),
    eqs. 17 to 20, with a basis as good as orthonormal.
    """
    runs, count = columns.shape[1], np.arange(1, len(columns) + 1)
    q, r = scipy.linalg.qr(columns.T, mode="economic")
    projected = q.T @ values
    residual = values[:, np.newaxis] - np.cumsum(q * projected, axis=1)
    free = np.maximum(1 - np.cumsum(q**2, axis=1), _SMALLEST)
    error = ((residual / free) ** 2).mean(axis=0) * (runs + count) / (runs - count)
    best = int(np.argmin(error)) + 1
    return np.asarray(scipy.linalg.solve_triangular(r[:best, :best], projected[:best]))
