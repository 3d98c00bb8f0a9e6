"""Sparse polynomial chaos from the runs of a sample.

Hybrid least angle regression: it picks the terms, and least squares fits their coefficients.
Blatman and Sudret (2011), J. Comput. Phys. 230, 2345, section 4.3.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.responses import listed
from impactlab.analysis.surrogate.chaos import Array, Chaos, basis, candidates
from impactlab.model.distributions import cumulative, is_distributed

_SHARE = 0.2
"""Share of the blocks of runs to test on."""
_MOST_TESTS = 4000
_BLOCKS = {"sobol": "base_samples", "morris": "trajectories"}
"""Methods whose runs come in blocks of near-copies, and the attribute with their number."""
_LENGTHS = {"fast": "samples"}
"""Methods whose blocks are curves through the cube, and the attribute with their length."""


@dataclass(frozen=True)
class Sample:
    """The points of a sample in the unit cube, in the order of `run`.

    parameters: names of the varied parameters. groups: the group of each, or again its name.
    unit: (runs, parameters), the probability of each value. block: (runs,), equal for runs that
    differ in few parameters. confidence: of intervals.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    unit: Array
    block: NDArray[np.int64]
    seed: int
    confidence: float

    @classmethod
    def of(cls, runs: xr.Dataset) -> Sample:
        """Return the sample of runs sorted by `run`. Raises ValueError where blocks do not fit."""
        names = listed(runs, "varied")
        columns = [cumulative(runs[name].attrs, runs[name].values) for name in names]
        return cls(
            parameters=tuple(names),
            groups=tuple(listed(runs, "groups") if "groups" in runs.attrs else names),
            unit=np.column_stack(columns),
            block=np.arange(runs.sizes["run"]) // _block_length(runs),
            seed=int(runs.attrs["seed"]),
            confidence=float(runs.attrs.get("confidence", 0.95)),
        )

    @property
    def labels(self) -> list[str]:
        """Names of the indices: groups, or parameters, in the order of the study file."""
        return list(dict.fromkeys(self.groups))

    @cached_property
    def held_out(self) -> NDArray[np.bool_]:
        """Mask of the runs that no surrogate sees, (runs,): a fifth of the blocks, one at least."""
        blocks = int(self.block[-1]) + 1
        chosen = self._random("held out").permutation(blocks)[: max(1, round(_SHARE * blocks))]
        return np.isin(self.block, chosen)

    @cached_property
    def tests(self) -> NDArray[np.int64]:
        """Positions of the held-out runs, rising; of more than _MOST_TESTS, a draw of as many."""
        found = np.flatnonzero(self.held_out)
        return np.sort(self._random("tests").permutation(found)[:_MOST_TESTS])

    @property
    def fit_seed(self) -> int:
        """Seed of the choice of runs to fit to."""
        return int(self._random("fit").integers(2**31))

    def _random(self, purpose: str) -> np.random.Generator:
        key = tuple(f"surrogate {purpose}".encode())
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=key))


def is_sample(runs: xr.Dataset) -> bool:
    """Return True if the runs are draws from distributions in their attributes."""
    return "run" in runs.dims and all(
        name in runs.coords and is_distributed(runs[name].attrs) for name in listed(runs, "varied")
    )


def _block_length(runs: xr.Dataset) -> int:
    method, count = str(runs.attrs.get("method")), runs.sizes["run"]
    if method in _LENGTHS:
        length = int(runs.attrs[_LENGTHS[method]])
    elif method in _BLOCKS:
        length = count // max(int(runs.attrs[_BLOCKS[method]]), 1)
    else:
        length = 1
    if length < 1 or count % length:
        raise ValueError(
            f"study {runs.attrs.get('study', '?')!r} has {count} runs, not a whole number of "
            f"blocks of its method {method}: solve it again"
        )
    return length


MOST_RUNS = 20_000
"""Largest number of runs that a fit uses; of more, it draws as many."""
_MOST_CANDIDATES = 400
_MOST_TERMS = 200
_HIGHEST_DEGREE = 20
_SMALLEST = 1e-12
"""Least leverage left to a run, so that nothing is divided by zero."""


def fewest_runs(parameters: int) -> int:
    """Return the number of runs that a fit needs: four per term of the linear model."""
    return 4 * (parameters + 1)


def drawn(runs: int, seed: int) -> NDArray[np.int64]:
    """Return the positions of the runs that a fit uses, rising: all, or a draw of MOST_RUNS."""
    return np.sort(np.random.default_rng(seed).permutation(runs)[:MOST_RUNS])


def fit(unit: Array, values: Array, seed: int) -> Chaos:
    """Return a chaos that predicts `values` from points of the unit cube.

    unit: (runs, parameters), the probabilities of the parameters' values; values: (runs,), finite.
    seed: which runs are used where there are more than MOST_RUNS. Raises ValueError when there
    are fewer than `fewest_runs`.
    """
    if len(values) < fewest_runs(unit.shape[1]):
        raise ValueError(
            f"{len(values)} runs are too few for a surrogate in {unit.shape[1]} parameters: "
            f"solve {fewest_runs(unit.shape[1])} or more"
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
    """Return the degree that the parameter with the fewest levels can resolve."""
    levels = min(np.unique(np.round(column, 9)).size for column in unit.T)
    return min(_HIGHEST_DEGREE, levels - 1)


def _order(columns: Array, values: Array) -> list[int]:
    """Return the terms in the order of least angle regression, the constant first.

    values: of mean zero.
    """
    # scikit-learn is a large dependency for one function, but its treatment of dependent terms and
    # round-off decides which terms are picked: another one would change stored results.
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.linear_model import lars_path_gram  # takes a second

    centred = columns[1:] - columns[1:].mean(axis=1, keepdims=True)
    centred /= np.linalg.norm(centred, axis=1, keepdims=True)
    # Scaled to norm one, as the terms are, because the tolerances are absolute.
    correlation = centred @ (values / (np.linalg.norm(values) or 1.0))
    with warnings.catch_warnings():
        # Of terms that the runs cannot distinguish it rightly drops one.
        warnings.simplefilter("ignore", ConvergenceWarning)
        _, active, _ = lars_path_gram(
            correlation,
            centred @ centred.T,
            n_samples=1,
            max_iter=min(_MOST_TERMS, len(values) // 4),
        )
    return [0, *(int(term) + 1 for term in active)]


def _least_squares(columns: Array, values: Array) -> Array:
    """Return the coefficients of the first terms, as many as predict best.

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
