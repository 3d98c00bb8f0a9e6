from __future__ import annotations

import pytest

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
def test_a_fixed_value_must_be_possible(problems, sampled, name, value, words):
    ((key, said),) = problems(sampled("sobol", {name: fixed(value)}, base_samples=8))
    assert key == f"sampling.parameters.{name}.value"
    assert words in said


def test_a_whole_number_may_be_fixed_but_not_drawn(problems, sampled):
    ((_, said),) = problems(sampled("sobol", {"nodes": UNIFORM}, base_samples=8))
    assert "or write {distribution: fixed, value: ...}" in said


@pytest.mark.parametrize("method", ["sobol", "morris", "fast", "delta", "pawn", "regression"])
def test_two_parameters_must_be_left_to_vary(problems, sampled, method):
    own = {"sobol": {"base_samples": 8}, "morris": {"trajectories": 4}}
    held = {"velocity": fixed(1), "beam_depth": fixed(0.02)}
    ((key, said),) = problems(sampled(method, held, **own.get(method, {"samples": 100})))
    assert key == "sampling.parameters"
    assert f"too few: method {method} varies 2 or more (fixed ones do not count)" in said


def test_fixed_values_are_checked_against_the_rest(problems, sampled):
    ((key, said),) = problems(sampled("sobol", {"beam_span": fixed(0.025)}, base_samples=8))
    assert key.startswith("sampling.parameters.beam_")
    assert "must be below the span" in said


def test_a_fixed_place_of_profiles_is_no_varied_one(problems, read, sample):
    profiles = {"store.profiles": True}
    depth = {"sampling.parameters.gravity": UNIFORM, "sampling.parameters.beam_depth": fixed(0.02)}
    assert read(sample(profiles | depth)).store.profiles
    ((key, _),) = problems(sample(profiles))
    assert key == "sampling.parameters.beam_depth"
