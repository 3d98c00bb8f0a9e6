from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError

from impactlab.study.declaration.distributions import DISTRIBUTIONS

CASES = {
    "uniform": {"low": 2.0, "high": 5.0},
    "log_uniform": {"low": 2.0, "high": 32.0},
    "normal": {"mean": 10.0, "standard_deviation": 2.0},
    "truncated_normal": {"mean": 10.0, "standard_deviation": 2.0, "low": 9.0, "high": 14.0},
    "lognormal": {"median": 10.0, "geometric_standard_deviation": 1.3},
    "triangular": {"low": 2.0, "mode": 3.0, "high": 8.0},
}


def made(name, **arguments):
    return DISTRIBUTIONS[name][float](distribution=name, **arguments)


def normal_density(x):
    return math.exp(-(x**2) / 2) / math.sqrt(2 * math.pi)


def normal_probability(x):
    return (1 + math.erf(x / math.sqrt(2))) / 2


def truncated_normal_mean(mean, deviation, low, high):
    a, b = (low - mean) / deviation, (high - mean) / deviation
    share = normal_probability(b) - normal_probability(a)
    return mean + deviation * (normal_density(a) - normal_density(b)) / share


MEANS = {
    "uniform": 3.5,
    "log_uniform": 30.0 / math.log(16.0),
    "normal": 10.0,
    "truncated_normal": truncated_normal_mean(10.0, 2.0, 9.0, 14.0),
    "lognormal": 10.0 * math.exp(math.log(1.3) ** 2 / 2),
    "triangular": 13.0 / 3.0,
}


def test_every_distribution_is_tested():
    assert CASES.keys() == DISTRIBUTIONS.keys() == MEANS.keys()


@pytest.mark.parametrize("name", CASES)
def test_mean_of_the_quantiles_is_that_of_the_closed_form(name):
    middle = (np.arange(200_000) + 0.5) / 200_000
    assert made(name, **CASES[name]).quantile(middle).mean() == pytest.approx(MEANS[name], rel=2e-5)


@pytest.mark.parametrize("name", CASES)
def test_quantiles_rise_and_keep_to_the_bounds(name):
    given = made(name, **CASES[name])
    values = given.quantile(np.array([2.0**-31, 1e-6, 0.3, 0.5, 0.9, 1 - 1e-6, 1 - 2.0**-31]))
    assert np.all(np.diff(values) > 0)
    assert np.all(np.isfinite(values))
    bounds = given.bounds()
    assert ("low" in CASES[name]) == bool(bounds)
    if bounds:
        assert bounds["low"] <= values[0] < values[-1] <= bounds["high"]


def test_special_quantiles():
    one_deviation = np.array([normal_probability(1.0)])
    half = np.array([0.5])
    assert made("normal", **CASES["normal"]).quantile(one_deviation) == pytest.approx(12.0)
    assert made("lognormal", **CASES["lognormal"]).quantile(one_deviation) == pytest.approx(13.0)
    assert made("log_uniform", **CASES["log_uniform"]).quantile(half) == pytest.approx(8.0)
    at_mode = np.array([1 / 6])  # (mode - low)/(high - low): the share below the mode
    assert made("triangular", **CASES["triangular"]).quantile(at_mode) == pytest.approx(3.0)


@pytest.mark.parametrize("name", CASES)
def test_arguments_are_those_given(name):
    assert made(name, **CASES[name]).arguments() == {"distribution": name, **CASES[name]}


@pytest.mark.parametrize(
    ("name", "change", "where", "words"),
    [
        ("uniform", {"high": 2.0}, "high", "must be above low"),
        ("uniform", {"low": 9.0}, "high", "must be above low"),
        ("log_uniform", {"low": 0.0}, "low", "must be above zero"),
        ("normal", {"standard_deviation": 0.0}, "standard_deviation", "must be above zero"),
        ("truncated_normal", {"high": 8.0}, "high", "must be above low"),
        ("truncated_normal", {"mean": 99.0}, None, "more than 8 standard deviations"),
        ("lognormal", {"median": -1.0}, "median", "must be above zero"),
        ("lognormal", {"geometric_standard_deviation": 0.1}, "geometric_standard_deviation", "1.1"),
        ("triangular", {"mode": 9.0}, "mode", "must lie from low to high"),
        ("triangular", {"mode": 1.0}, "mode", "must lie from low to high"),
    ],
)
def test_contradictory_arguments_are_refused(name, change, where, words):
    with pytest.raises(ValidationError) as caught:
        made(name, **(CASES[name] | change))
    (line,) = caught.value.errors()
    assert line["loc"] == ((where,) if where else ())
    assert words in line["msg"]
