"""Distributions and fixed values of sampled parameters."""

import pytest
from pydantic import ValidationError

from impactlab.methods.distributions import DISTRIBUTIONS
from impactlab.model.parameters import Parameter

CASES = {
    "uniform": {"low": 2.0, "high": 5.0},
    "log_uniform": {"low": 2.0, "high": 32.0},
    "normal": {"mean": 10.0, "standard_deviation": 2.0},
    "truncated_normal": {"mean": 10.0, "standard_deviation": 2.0, "low": 9.0, "high": 14.0},
    "lognormal": {"median": 10.0, "geometric_standard_deviation": 1.3},
    "triangular": {"low": 2.0, "mode": 3.0, "high": 8.0},
    "integers": {"low": 3, "high": 11, "step": 2},
    "steps": {"low": 0.1, "high": 0.7, "step": 0.2},
}


def made(name, **arguments):
    context = {"keys": {}, "parameter": Parameter("x", "1", "x", ())}
    return DISTRIBUTIONS[name].read({"distribution": name, **arguments}, context)


CONTRADICTIONS = [
    ("uniform", {"high": 2.0}, "high", "must be above low"),
    ("uniform", {"low": 9.0}, "high", "must be above low"),
    ("log_uniform", {"low": 0.0}, "low", "must be above 0"),
    ("normal", {"standard_deviation": 0.0}, "standard_deviation", "must be above 0"),
    ("truncated_normal", {"high": 8.0}, "high", "must be above low"),
    ("truncated_normal", {"mean": 99.0}, None, "more than 8 standard deviations"),
    ("lognormal", {"median": -1.0}, "median", "must be above 0"),
    ("lognormal", {"geometric_standard_deviation": 0.1}, "geometric_standard_deviation", "1.1"),
    ("triangular", {"mode": 9.0}, "mode", "must lie from low to high"),
    ("triangular", {"mode": 1.0}, "mode", "must lie from low to high"),
    ("integers", {"high": 3}, "high", "must be above low"),
    ("integers", {"low": 2.5}, "low", "expected a whole number"),
    ("integers", {"step": 3}, "step", "does not lead from low to high"),
    ("steps", {"high": 0.1}, "high", "must be above low"),
    ("steps", {"step": 0.0}, "step", "must be above 0"),
    ("steps", {"step": 0.25}, "step", "does not lead from low to high"),
]


def test_every_distribution_is_tested():
    assert CASES.keys() == DISTRIBUTIONS.keys() == {name for name, *_ in CONTRADICTIONS}


@pytest.mark.parametrize(("name", "change", "where", "words"), CONTRADICTIONS)
def test_contradictory_arguments_are_refused(name, change, where, words):
    with pytest.raises(ValidationError) as caught:
        made(name, **(CASES[name] | change))
    (line,) = caught.value.errors()
    key = line["loc"] or ((line["ctx"]["key"],) if line["type"] == "at_key" else ())
    assert key == ((where,) if where else ())
    assert words in line["msg"]


UNIFORM = {"distribution": "uniform", "low": 1, "high": 2}


def fixed(value):
    return {"distribution": "fixed", "value": value}


@pytest.mark.parametrize(
    ("name", "given", "value"),
    [("beam_width", "60 mm", 0.06), ("nodes", 51, 51), ("contact", "hertz", "hertz")],
)
def test_a_fixed_parameter_is_not_varied(read, sampled, name, given, value):
    sampling = read(sampled("sobol", {name: fixed(given)}, base_samples=8)).sampling
    assert list(sampling.varied) == ["velocity", "beam_depth", "gravity"]
    assert sampling.fixed == {name: value}
    assert type(sampling.fixed[name]) is type(value)
    assert sampling.runs == 8 * (2 * 3 + 2)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("beam_width", "60 kg", "expected a length"),
        ("beam_width", -1, "must be above zero"),
        ("nodes", 50, "must be odd"),
        ("contact", "herz", "did you mean 'hertz'?"),
    ],
)
def test_a_fixed_value_must_be_possible(refused, sampled, name, value, words):
    text = sampled("sobol", {name: fixed(value)}, base_samples=8)
    refused(text, f"sampling.parameters.{name}.value", words)


def test_a_whole_number_is_fixed_or_drawn_among_whole_numbers(read, refused, sampled):
    text = sampled("sobol", {"nodes": UNIFORM}, base_samples=8)
    refused(text, "sampling.parameters.nodes", "write {distribution: integers, low: ...")
    whole = {"distribution": "integers", "low": 21, "high": 81, "step": 20}
    drawn = read(sampled("sobol", {"nodes": whole}, base_samples=8)).sampling.columns()["nodes"]
    assert {*drawn.tolist()} <= {21, 41, 61, 81}
    even = sampled("sobol", {"nodes": whole | {"high": 80, "step": 1}}, base_samples=8)
    refused(even, "sampling.parameters.nodes.high", "must be odd")


@pytest.mark.parametrize("method", ["sobol", "morris", "fast", "delta", "pawn", "regression"])
def test_a_parameter_must_be_left_to_vary(refused, sampled, method):
    own = {"sobol": {"base_samples": 8}, "morris": {"trajectories": 4}}
    held = {"velocity": fixed(1), "beam_depth": fixed(0.02), "gravity": fixed(0)}
    text = sampled(method, held, **own.get(method, {"samples": 100}))
    words = f"too few: method {method} varies 1 or more (fixed ones do not count)"
    refused(text, "sampling.parameters", words)


def test_fixed_values_are_checked_against_the_rest(problems, sampled):
    ((key, said),) = problems(sampled("sobol", {"beam_span": fixed(0.025)}, base_samples=8))
    assert key.startswith("sampling.parameters.beam_")
    assert "must be below the span" in said


def test_a_fixed_place_of_profiles_is_no_varied_one(refused, read, sample):
    profiles, key = {"store.profiles": True}, "sampling.parameters.beam_depth"
    depth = {"sampling.parameters.gravity": UNIFORM, key: fixed(0.02)}
    assert read(sample(profiles | depth)).store.profiles
    refused(sample(profiles), key)
