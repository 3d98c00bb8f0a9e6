"""Surrogates of all responses of a sample: fitted, tested on held-out runs, and judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.responses import usable
from impactlab.analysis.surrogate.chaos import (
    Array,
    Chaos,
    Degrees,
    Errors,
    Fitted,
    Indices,
    indices,
)
from impactlab.analysis.surrogate.fitting import Sample, drawn, fewest_runs, fit, is_sample
from impactlab.analysis.verdicts import ROUND_OFF, Verdict, flagged

GOOD = 0.9
"""Predictivity on held-out runs from which on a surrogate needs no warning."""
MOSTLY = 0.9
FEW = 20
"""Distinct values up to which a response jumps between levels, where each comes ten times."""


class SurrogateVerdict(Verdict):
    """Verdicts on the surrogate of a response."""

    USABLE = 0, True, "it predicts at least 90 % of the variance of runs held out"
    POOR = 1, False, "it misses more than a tenth of the variance of runs held out"
    JUMPS = 2, False, "the response jumps between few values, which no polynomial follows"
    MOSTLY_CONSTANT = 3, False, "nine runs in ten share one value: it follows the others badly"
    FAILED_RUNS = 4, False, "runs are missing: it knows nothing of where they failed"
    TOO_FEW_RUNS = 5, False, "too few runs answered to fit and to test one: there is none"
    CONSTANT = 6, False, "the response does not vary: there is none"


def before_fitting(values: Array, enough: bool) -> SurrogateVerdict:
    """Return the verdict from the runs alone; values: (runs,), NaN where missing.

    enough: whether there are enough runs to fit and to test.
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
    """Return the verdict after the test: POOR where it was USABLE; a NaN is poor, too."""
    poor = before is SurrogateVerdict.USABLE and not predictivity >= GOOD
    return SurrogateVerdict.POOR if poor else before


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
    """Return verdict and surrogate of one response; None where constant or with too few runs.

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
    """Return the errors of predictions at known values; q2 is -inf where these are all equal."""
    known = np.isfinite(values)
    square = float(np.mean((predicted - values)[known] ** 2))
    variance = float(np.var(values[known]))
    return Errors(1 - square / variance if variance > 0 else -np.inf, float(np.sqrt(square)))


Found = Sequence[Tested | None]
"""The surrogate of each response, or none."""


def applies(runs: xr.Dataset) -> bool:
    """Return True if the runs are a sample, by any method, with distributions of parameters."""
    return is_sample(runs)


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return a polynomial chaos of every response, its test and its Sobol indices.

    Returns, on (response): surrogate_verdict, surrogate_q2 (1 less mean squared error over
    variance, of held-out runs), surrogate_rmse (in the unit of the response), surrogate_runs
    (fitted to). surrogate_held_out (response, held_out): predictions at the runs whose numbers
    the coordinate held_out tells. surrogate_first_order and surrogate_total_order (response,
    parameter), each with <name>_interval, a half-width (see `indices`). surrogate_coefficient
    (response, surrogate_term) and surrogate_degree (surrogate_term, surrogate_input): the chaos
    (see `basis`). NaN where a response has no surrogate. Raises ValueError when the number of
    runs does not fit the sample.
    """
    runs = runs.sortby("run")
    sample, values = Sample.of(runs), usable(runs).transpose("response", "run")
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        pairs = [surrogate(row, sample) for row in values.values]
    codes = xr.DataArray([int(verdict) for verdict, _ in pairs], dims="response")
    found = [tested for _, tested in pairs]
    variables = _numbers(found) | _tests(found, sample) | _indices(found, sample)
    dataset = xr.Dataset(
        variables | _terms(found, sample), _coordinates(values, sample, runs["run"].values)
    )
    return dataset.assign(
        surrogate_verdict=flagged(codes, SurrogateVerdict, "verdict on the surrogate")
    )


def _coordinates(values: xr.DataArray, sample: Sample, numbers: Any) -> dict[str, Any]:
    lists = {
        "held_out": (numbers[sample.tests], "number of a run held out"),
        "parameter": (sample.labels, "varied parameter"),
        "surrogate_input": (list(sample.parameters), "parameter that the surrogate depends on"),
    }
    return {
        str(name): array.variable
        for name, array in values.coords.items()
        if array.dims == ("response",)
    } | {name: (name, entries, {"long_name": words}) for name, (entries, words) in lists.items()}


def _numbers(found: Found) -> dict[str, Any]:
    def row(name: str, none: float, words: str, **attrs: str) -> tuple[str, list[Any], Any]:
        values = [attrgetter(name)(one) if one else none for one in found]
        return "response", values, {"long_name": words, **attrs}

    error = "1 - mean squared error / variance over the runs held out"
    root = "root mean squared error over the runs held out, in the unit of the response"
    return {
        "surrogate_q2": row(
            "errors.q2", np.nan, f"predictivity of the surrogate: {error}", units="1"
        ),
        "surrogate_rmse": row("errors.rmse", np.nan, root),
        "surrogate_runs": row("runs", 0, "runs that the surrogate was fitted to", units="1"),
    }


def _tests(found: Found, sample: Sample) -> dict[str, Any]:
    rows = _rows(found, attrgetter("predicted"), sample.tests.size)
    attrs = {"long_name": "the surrogate's value at a run held out, in the unit of the response"}
    return {"surrogate_held_out": (("response", "held_out"), rows, attrs)}


def _indices(found: Found, sample: Sample) -> dict[str, Any]:
    dims, confidence = ("response", "parameter"), sample.confidence
    variables = {}
    for order in ("first_order", "total_order"):
        words = f"{order.replace('_', '-')} Sobol index of the surrogate"
        attrs = {"long_name": words, "units": "1", "estimator": "polynomial chaos"}
        half_width = f"half-width of the {100 * confidence:g} % interval of the {words}"
        for name, own in (
            (order, attrs),
            (f"{order}_interval", attrs | {"long_name": half_width, "confidence": confidence}),
        ):
            of = attrgetter(f"indices.{name}")
            variables[f"surrogate_{name}"] = (dims, _rows(found, of, len(sample.labels)), own)
    return variables


def _terms(found: Found, sample: Sample) -> dict[str, Any]:
    """Return the terms of all responses, and the coefficients of each: zero where it has none."""
    constant: Degrees = np.zeros((1, len(sample.parameters)), dtype=np.int64)
    degrees = np.unique(
        np.concatenate([constant, *(one.chaos.degrees for one in found if one)]), axis=0
    )
    at = {tuple(row): position for position, row in enumerate(degrees.tolist())}

    def spread(one: Tested) -> Array:
        row = np.zeros(len(degrees))
        row[[at[tuple(term)] for term in one.chaos.degrees.tolist()]] = one.chaos.coefficients
        return row

    words = "coefficient of each Legendre product, in the unit of the response"
    degree = "degree of each term's Legendre polynomial in each parameter"
    return {
        "surrogate_coefficient": (
            ("response", "surrogate_term"),
            _rows(found, spread, len(degrees)),
            {"long_name": words},
        ),
        "surrogate_degree": (
            ("surrogate_term", "surrogate_input"),
            degrees,
            {"long_name": degree, "units": "1"},
        ),
    }


def _rows(found: Found, row: Callable[[Tested], Array], length: int) -> Array:
    return np.array([row(one) if one else np.full(length, np.nan) for one in found])
