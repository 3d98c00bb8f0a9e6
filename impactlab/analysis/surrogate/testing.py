"""The surrogate of one response: fitted to most blocks of runs, tested on the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impactlab.analysis.surrogate.chaos import Array, Chaos
from impactlab.analysis.surrogate.fitting import drawn, fewest_runs, fit
from impactlab.analysis.surrogate.indices import Errors, Fitted, Indices, indices
from impactlab.analysis.surrogate.sample import Sample
from impactlab.analysis.surrogate.verdict import SurrogateVerdict, after_testing, before_fitting

_FEWEST_TESTS = 10


@dataclass(frozen=True)
class Tested:
    """A chaos and how well it predicts.

    predicted: (tests,), in the response's unit. errors: on the tests that have a value. runs: how
    many the chaos was fitted to.
    """

    chaos: Chaos
    predicted: Array
    errors: Errors
    runs: int
    indices: Indices


def surrogate(values: Array, sample: Sample) -> tuple[SurrogateVerdict, Tested | None]:
    """Verdict and surrogate of one response; none where it is constant or runs are too few.

    values: (runs,), NaN where missing.
    """
    answered = np.isfinite(values)
    training = np.flatnonzero(answered & ~sample.held_out)
    enough = bool(
        training.size >= fewest_runs(len(sample.parameters))
        and np.count_nonzero(answered[sample.tests]) >= _FEWEST_TESTS
    )
    verdict = before_fitting(values, enough)
    if verdict in (SurrogateVerdict.TOO_FEW_RUNS, SurrogateVerdict.CONSTANT):
        return verdict, None
    tested = _tested(values, sample, training)
    return after_testing(verdict, tested.errors.q2), tested


def _tested(values: Array, sample: Sample, training: NDArray[np.int64]) -> Tested:
    rows = training[drawn(training.size, sample.fit_seed)]
    fitted = Fitted(sample.unit[rows], values[rows], sample.block[rows])
    chaos = fit(fitted.unit, fitted.values, sample.fit_seed)
    predicted = chaos(sample.unit[sample.tests])
    errors = _errors(predicted, values[sample.tests])
    found = indices(chaos, sample.groups, fitted, errors, sample.confidence)
    return Tested(chaos, predicted, errors, rows.size, found)


def _errors(predicted: Array, values: Array) -> Errors:
    """Of predictions with a value to hold them against; q2 is -inf where the values are alike."""
    known = np.isfinite(values)
    square = float(np.mean((predicted - values)[known] ** 2))
    variance = float(np.var(values[known]))
    return Errors(1 - square / variance if variance > 0 else -np.inf, float(np.sqrt(square)))
