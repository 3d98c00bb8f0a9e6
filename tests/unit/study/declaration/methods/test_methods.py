"""How many runs each method has, and what it refuses."""

from __future__ import annotations

import pytest

from impactlab.model.parameters import Parameter
from impactlab.study.declaration.methods import METHODS, sampling_reader
from impactlab.study.declaration.values import Factor

RUNS = [
    ("sobol", {"base_samples": 16}, 16 * (2 * 3 + 2)),
    ("sobol", {"base_samples": 16, "second_order": False}, 16 * (3 + 2)),
    ("morris", {"trajectories": 10}, 10 * (3 + 1)),
    ("morris", {"trajectories": 10, "optimal_trajectories": 4, "levels": 6}, 4 * (3 + 1)),
    ("fast", {"samples": 65}, 65 * (3 + 1)),
    ("fast", {"samples": 145, "harmonics": 6}, 145 * (3 + 1)),
    ("delta", {"samples": 100}, 100),
    ("pawn", {"samples": 100}, 100),
    ("regression", {"samples": 100}, 100),
]
WRONG = [
    ("morris", {"trajectories": 1}, "trajectories", "must lie from 2"),
    ("morris", {"trajectories": 4, "levels": 5}, "levels", "must be even"),
    ("morris", {"trajectories": 4, "optimal_trajectories": 4}, "optimal_trajectories", "2 to 3"),
    ("morris", {"trajectories": 4, "optimal_trajectories": 1}, "optimal_trajectories", "2 to 3"),
    (
        "morris",
        {"trajectories": 1000, "optimal_trajectories": 50},
        "optimal_trajectories",
        "takes too long to choose",
    ),
    ("fast", {"samples": 64}, "samples", "must be at least 65 (above 4 harmonics²)"),
    ("fast", {"samples": 144, "harmonics": 6}, "samples", "must be at least 145"),
    ("delta", {"samples": 63}, "samples", "must lie from 64"),
    ("pawn", {"samples": 100, "base_samples": 8}, "base_samples", "unknown key; did you mean"),
    ("sobol", {}, "base_samples", "is required"),
]


@pytest.mark.parametrize(("method", "given", "runs"), RUNS)
def test_number_of_runs(read, sampled, method, given, runs):
    study = read(sampled(method, **given))
    assert (study.sampling.method, study.runs) == (method, runs)
    assert study.size == f"{runs} runs"
    assert study.sampling.seed == 1


def test_every_method_is_counted():
    assert {method for method, *_ in RUNS} | {"grid"} == METHODS.keys()


@pytest.mark.parametrize(("method", "given", "key", "words"), WRONG)
def test_a_mistake_is_one_problem_at_its_key(problems, sampled, method, given, key, words):
    ((where, said),) = problems(sampled(method, **given))
    assert where == f"sampling.{key}"
    assert words in said


@pytest.mark.parametrize(
    "given",
    [
        {"distribution": "normal", "mean": 1, "standard_deviation": 0.1},
        {"distribution": "lognormal", "median": 1, "geometric_standard_deviation": 1.1},
    ],
)
def test_morris_takes_no_distribution_without_ends(problems, read, sampled, given):
    text = sampled("morris", {"sphere_mass": given}, trajectories=4)
    ((key, said),) = problems(text)
    assert key == "sampling.parameters.sphere_mass.distribution"
    assert "has no ends" in said
    assert "truncated_normal" in said
    assert read(sampled("fast", {"sphere_mass": given}, samples=65)).runs == 65 * 5


@pytest.mark.parametrize("method", sorted(METHODS.keys() - {"grid"}))
def test_failed_runs_are_no_indices_unless_asked_to_be_supplied(read, problems, sampled, method):
    own = {name: given for name, given, _ in RUNS}
    text = sampled(method, **own[method])
    assert read(text).analysis.failed_runs == "fail"
    asked = text[:-1] + ', "analysis": {"failed_runs": "impute"}}'
    assert read(asked).analysis.failed_runs == "impute"
    ((key, said),) = problems(text[:-1] + ', "analysis": {"failed_runs": "mean"}}')
    assert key == "analysis.failed_runs"
    assert "unknown policy; choose from fail, impute" in said


def test_other_parameters_than_those_of_an_impact(read):
    """Of a test function, say."""

    def below_four(value):
        if value >= 4:
            raise ValueError("must be below 4")

    factors = {
        name: Factor(Parameter(name, "1", name, ()), below_four) for name in ("x1", "x2", "x3")
    }
    reader = sampling_reader(factors)
    uniform = {"distribution": "uniform", "low": -3, "high": 3}
    section = {"method": "sobol", "base_samples": 8, "parameters": {"x1": uniform, "x3": uniform}}
    info = type("Info", (), {"context": None})()
    sampling = reader(section, info)
    assert list(sampling.varied) == ["x1", "x3"]
    assert sampling.runs == 8 * 6
    section["parameters"]["x2"] = uniform | {"high": 4}
    with pytest.raises(ValueError, match="must be below 4"):
        reader(section, info)
