from __future__ import annotations

import pytest

GROUPS = {"others": ["gravity", "velocity"]}
WRONG = [
    ({"all": ["velocity", "beam_depth", "gravity"]}, "groups", "too few: 2 groups or more"),
    ({"beam_depth": ["velocity", "gravity"]}, "groups.beam_depth", "is the name of a parameter"),
    ({"a": ["velocity", "gravty"]}, "groups.a.1", "did you mean 'gravity'?"),
    ({"a": ["velocity", "beam_width"]}, "groups.a.1", "unknown varied parameter"),
    ({"a": ["velocity"], "b": ["velocity"]}, "groups.b.0", "is named more than once"),
    ({"a": ["velocity", "velocity"]}, "groups.a.1", "is named more than once"),
    ({"a": ["velocity", "sphere_mass"]}, "groups.a.1", "is fixed: it belongs to no group"),
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
        ("morris", {"trajectories": 10, "optimal_trajectories": 4}, 4 * (2 + 1)),
    ],
)
def test_groups_count_instead_of_parameters(read, sampled, method, given, runs):
    sampling = read(sampled(method, groups=GROUPS, **given)).sampling
    assert sampling.runs == runs
    assert sampling.group_of == {
        "velocity": "others",
        "beam_depth": "beam_depth",
        "gravity": "others",
    }


def test_without_groups_each_parameter_is_its_own(read, sampled):
    sampling = read(sampled("morris", trajectories=4)).sampling
    assert all(name == group for name, group in sampling.group_of.items())


@pytest.mark.parametrize(("groups", "key", "words"), WRONG)
def test_a_mistake_in_groups_is_one_problem_at_its_key(problems, sampled, groups, key, words):
    mass = {"sphere_mass": {"distribution": "fixed", "value": 1}}
    text = sampled("sobol", mass, base_samples=8, groups=groups)
    ((where, said),) = problems(text)
    assert where == f"sampling.{key}"
    assert words in said


def test_a_group_that_yaml_takes_for_a_number_is_refused(problems, sample):
    text = sample().replace("  parameters:", "  groups: {3: [velocity]}\n  parameters:")
    ((where, said),) = problems(text)
    assert where == "sampling.groups"
    assert "3 cannot name a group" in said


@pytest.mark.parametrize("method", ["fast", "delta", "pawn", "regression"])
def test_methods_without_groups_say_so(problems, sampled, method):
    ((where, said),) = problems(sampled(method, samples=100, groups=GROUPS))
    assert where == "sampling.groups"
    assert "with method: sobol or morris" in said
