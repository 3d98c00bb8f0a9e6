"""The section `sampling`: its methods, groups and `until`."""

import json

import pytest

from impactlab.methods import METHODS
from impactlab.methods.hypercube import Hypercube
from impactlab.validation.errors import StudyError

RUNS = [
    ("sobol", {"base_samples": 16}, 16 * (2 * 3 + 2)),
    ("sobol", {"base_samples": 16, "second_order": False}, 16 * (3 + 2)),
    ("morris", {"trajectories": 10}, 10 * (3 + 1)),
    ("morris", {"trajectories": 4, "levels": 6}, 4 * (3 + 1)),
    ("fast", {"samples": 1188}, 1188 * (3 + 1)),
    ("fast", {"samples": 1259}, 1188 * (3 + 1)),  # whole periods, at an odd frequency
    ("fast", {"samples": 2548, "harmonics": 6}, 2548 * (3 + 1)),
    ("delta", {"samples": 100}, 100),
    ("pawn", {"samples": 100}, 100),
    ("regression", {"samples": 100}, 100),
    ("latin", {"samples": 100, "indices": ["delta", "pawn"]}, 100),
]
WRONG = [
    ("morris", {"trajectories": 1}, "trajectories", "must be at least 2"),
    ("morris", {"trajectories": 4, "levels": 5}, "levels", "must be even"),
    ("fast", {"samples": 65}, "samples", "must be at least 1,188 for 4 harmonics of 3 parameters"),
    ("fast", {"samples": 2547, "harmonics": 6}, "samples", "must be at least 2,548"),
    ("fast", {"samples": 9999, "harmonics": 3}, "harmonics", "must be at least 4"),
    ("delta", {"samples": 63}, "samples", "must be at least 64"),
    ("pawn", {"samples": 99}, "samples", "must be at least 100"),
    ("pawn", {"samples": 100, "base_samples": 8}, "base_samples", "unknown key; did you mean"),
    ("sobol", {}, "base_samples", "is required"),
    ("latin", {"samples": 100}, "indices", "is required"),
    ("latin", {"samples": 99, "indices": "all"}, "samples", "must be at least 100 for pawn"),
    ("latin", {"samples": 100, "indices": ["sobol"]}, "indices.0", "unknown index"),
]


@pytest.mark.parametrize(("method", "given", "runs"), RUNS)
def test_number_of_runs(read, sampled, method, given, runs):
    study = read(sampled(method, **given))
    assert (study.sampling.method, study.sampling.runs) == (method, runs)
    assert study.size == f"{runs:,} runs"
    assert study.sampling.seed == 1


def test_every_method_is_counted():
    """A new one from given data has its runs for the asking."""
    from_given_data = {name for name, kind in METHODS.items() if issubclass(kind, Hypercube)}
    assert {method for method, *_ in RUNS} | {"grid"} >= METHODS.keys() - from_given_data


@pytest.mark.parametrize(
    "given",
    [
        {"distribution": "normal", "mean": 1, "standard_deviation": 0.1},
        {"distribution": "lognormal", "median": 1, "geometric_standard_deviation": 1.1},
    ],
)
def test_morris_takes_no_distribution_without_ends(refused, read, sampled, given):
    text = sampled("morris", {"sphere_mass": given}, trajectories=4)
    key = "sampling.parameters.sphere_mass.distribution"
    refused(text, key, "has no ends", "truncated_normal")
    assert read(sampled("fast", {"sphere_mass": given}, samples=1476)).sampling.runs == 1476 * 5


@pytest.mark.parametrize("method", sorted(METHODS.keys() - {"grid"}))
def test_failed_runs_are_no_indices_unless_asked_to_be_supplied(read, refused, sampled, method):
    own = {name: keys for name, keys, _ in RUNS}
    text = sampled(method, **own.get(method, {"samples": 128}))
    assert read(text).analysis.failed_runs == "fail"
    asked = text[:-1] + ', "analysis": {"failed_runs": "impute"}}'
    assert read(asked).analysis.failed_runs == "impute"
    wrong = text[:-1] + ', "analysis": {"failed_runs": "mean"}}'
    refused(wrong, "analysis.failed_runs", "unknown policy; choose from fail, impute")


def test_other_parameters_than_those_of_an_impact(read):
    """A test function has others, for example."""
    uniform = {"distribution": "uniform", "low": -3, "high": 3}
    given = {"x1": uniform, "x3": uniform}
    section = {"method": "sobol", "base_samples": 8, "parameters": given}
    file = {"title": "Others", "function": "ishigami", "sampling": section}
    sampling = read(json.dumps(file)).sampling
    assert list(sampling.varied) == ["x1", "x3"]
    assert sampling.runs == 8 * 6
    given["velocity"] = uniform
    with pytest.raises(StudyError, match="unknown key; choose from x1, x2, x3"):
        read(json.dumps(file))


GROUPS = {"others": ["gravity", "velocity"]}
WRONG_GROUPS = [
    ({"beam_depth": ["velocity", "gravity"]}, "groups.beam_depth", "is the name of a parameter"),
    ({"a": ["velocity", "gravty"]}, "groups.a.1", "did you mean 'gravity'?"),
    ({"a": ["velocity", "beam_width"]}, "groups.a.1", "unknown varied parameter"),
    ({"a": ["velocity"], "b": ["velocity"]}, "groups.b.0", "is named more than once"),
    ({"a": ["velocity", "velocity"]}, "groups.a.1", "is named more than once"),
    ({"a": ["velocity", "sphere_mass"]}, "groups.a.1", "is fixed, so it belongs to no group"),
    ({"a": []}, "groups.a", "list at least one"),
    ({"a": "velocity"}, "groups.a", "expected a list of names"),
    ({"a": [3]}, "groups.a.0", "expected text"),
    ({"3 4": ["velocity"]}, "groups", "'3 4' cannot name a group"),
    (["velocity"], "groups", "expected a mapping such as"),
]


@pytest.mark.parametrize(
    ("method", "given", "runs"),
    [
        ("sobol", {"base_samples": 16}, 16 * (2 * 2 + 2)),
        ("sobol", {"base_samples": 16, "second_order": False}, 16 * (2 + 2)),
        ("morris", {"trajectories": 10}, 10 * (2 + 1)),
    ],
)
def test_groups_count_instead_of_parameters(read, sampled, method, given, runs):
    sampling = read(sampled(method, groups=GROUPS, **given)).sampling
    assert sampling.runs == runs
    expected = {"velocity": "others", "beam_depth": "beam_depth", "gravity": "others"}
    assert sampling.group_of == expected
    together = {"all": ["velocity", "beam_depth", "gravity"]}
    assert read(sampled(method, groups=together, **given)).sampling.group_count == 1
    alone = read(sampled(method, **given)).sampling
    assert all(name == group for name, group in alone.group_of.items())


def test_a_group_that_yaml_takes_for_a_number_is_refused(refused, sample):
    text = sample().replace("  parameters:", "  groups: {3: [velocity]}\n  parameters:")
    refused(text, "sampling.groups", "3 cannot name a group")


@pytest.mark.parametrize("method", ["fast", "delta", "pawn", "regression"])
def test_methods_without_groups_say_so(refused, sampled, method):
    text = sampled(method, samples=100, groups=GROUPS)
    refused(text, "sampling.groups", "with method: sobol or morris")


UNTIL = {"interval": "2 %", "runs": 2000}
WRONG_UNTIL = [
    ({"interval": 0.0009}, "interval", "must be at least 0.001"),
    ({"interval": 0.6}, "interval", "must be at most 0.5"),
    ({"runs": 511}, "runs", "must be at least the first sample's 512 runs"),
    ({"runs": 2_000_000_001}, "runs", "must be at most 2,000,000,000"),
    ({"responses": []}, "responses", "list at least one"),
    ({"responses": ["peak_forse"]}, "responses.0", "did you mean 'peak_force'?"),
    ({"intervall": 0.1}, "intervall", "did you mean 'interval'?"),
]


def test_a_sample_may_grow(read, sampled, problems, refused):
    study = read(sampled("sobol", base_samples=64, until=UNTIL))
    assert study.sampling.until.interval == 0.02
    assert study.sampling.runs == 512
    assert study.size == "512 runs, at most 2,000"
    read(sampled("sobol", base_samples=64, until=UNTIL | {"runs": 512}))
    # both limits are required
    found = problems(sampled("sobol", base_samples=64, until={}))
    assert {key for key, _ in found} == {"sampling.until.interval", "sampling.until.runs"}
    # intervals of very few samples decide nothing
    text = sampled("sobol", base_samples=32, until=UNTIL)
    refused(text, "sampling.base_samples", "must be at least 64 with until")
    # responses must be asked of the study
    until = UNTIL | {"responses": ["contact_duration"]}
    text = sampled("sobol", base_samples=64, until=until)
    asked = text[:-1] + ', "responses": ["peak_force"]}'
    refused(asked, "sampling.until.responses.0", "choose from peak_force")
    assert read(text).sampling.until.responses == ("contact_duration",)
    # the indices must be asked for
    text = sampled("sobol", base_samples=64, until=UNTIL)
    text = text[:-1] + ', "analyses": ["convergence_in_nodes"]}'
    assert "sampling.until" in {key for key, _ in problems(text)}


PLACED = {"coefficient_of_variation": "10 %", "runs": 400}


def test_runs_may_be_placed_for_a_probability(read, sampled, problems, refused):
    def text(until=PLACED, **settings):
        limits = '"limits": {"peak_force": "9 kN"}'
        return sampled("pawn", samples=100, until=until, **settings)[:-1] + f", {limits}" + "}"

    study = read(text())
    assert study.sampling.until.coefficient_of_variation == 0.1
    assert study.size == "100 runs, at most 500"
    refused(sampled("pawn", samples=100, until=PLACED), "sampling.until", "state that one in")
    refused(text(PLACED | {"runs": 299}), "sampling.until.runs", "must be at least 300")
    found = problems(text(UNTIL))
    assert "sampling.until.coefficient_of_variation" in {key for key, _ in found}


FIXED = {"sphere_mass": {"distribution": "fixed", "value": 1}}
MISTAKES = [
    *WRONG,
    *(
        ("sobol", {"parameters": FIXED, "base_samples": 8, "groups": groups}, key, words)
        for groups, key, words in WRONG_GROUPS
    ),
    *(
        ("sobol", {"base_samples": 64, "until": UNTIL | change}, f"until.{key}", words)
        for change, key, words in WRONG_UNTIL
    ),
]


@pytest.mark.parametrize(("method", "given", "key", "words"), MISTAKES)
def test_a_mistake_is_one_problem_at_its_key(refused, sampled, method, given, key, words):
    refused(sampled(method, **given), f"sampling.{key}", words)
