"""Surrogates of all responses of a sample, as variables of analysis.nc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from impactlab.analysis.responses import usable
from impactlab.analysis.surrogate.chaos import Array
from impactlab.analysis.surrogate.sample import Sample, is_sample
from impactlab.analysis.surrogate.terms import Degrees
from impactlab.analysis.surrogate.testing import Tested, surrogate
from impactlab.analysis.surrogate.verdict import SurrogateVerdict
from impactlab.analysis.verdicts import flagged

Found = Sequence[Tested | None]
"""The surrogate of each response, or none."""


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a sample, by any method, with the distributions of its parameters."""
    return is_sample(runs)


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """A polynomial chaos of every response, its test on held-out runs, and its Sobol indices.

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
    """The terms that any response has, and each one's coefficients: zero where it has not."""
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
