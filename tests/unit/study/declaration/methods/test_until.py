from __future__ import annotations

import pytest

UNTIL = {"interval": "2 %", "runs": 2000}
WRONG = [
    ({"interval": 0.0009}, "interval", "must lie from 0.001 to 0.5"),
    ({"interval": 0.6}, "interval", "must lie from 0.001 to 0.5"),
    ({"runs": 511}, "runs", "must be at least the first sample's 512 runs"),
    ({"runs": 10_000_001}, "runs", "must lie from 1 to 10,000,000"),
    ({"responses": []}, "responses", "list at least one"),
    ({"responses": ["peak_forse"]}, "responses.0", "did you mean 'peak_force'?"),
    ({"intervall": 0.1}, "intervall", "did you mean 'interval'?"),
]


def test_a_sample_may_grow(read, sampled):
    study = read(sampled("sobol", base_samples=64, until=UNTIL))
    assert study.sampling.until.interval == 0.02
    assert study.runs == 512
    assert study.size == "512 runs, at most 2,000"
    read(sampled("sobol", base_samples=64, until=UNTIL | {"runs": 512}))


@pytest.mark.parametrize(("change", "key", "words"), WRONG)
def test_a_mistake_is_one_problem_at_its_key(problems, sampled, change, key, words):
    ((where, said),) = problems(sampled("sobol", base_samples=64, until=UNTIL | change))
    assert where == f"sampling.until.{key}"
    assert words in said


def test_both_limits_are_required(problems, sampled):
    found = problems(sampled("sobol", base_samples=64, until={}))
    assert {key for key, _ in found} == {"sampling.until.interval", "sampling.until.runs"}


def test_intervals_of_very_few_samples_decide_nothing(problems, sampled):
    ((where, said),) = problems(sampled("sobol", base_samples=32, until=UNTIL))
    assert where == "sampling.base_samples"
    assert "must be at least 64 with until" in said


def test_responses_must_be_asked_of_the_study(problems, read, sampled):
    until = UNTIL | {"responses": ["contact_duration"]}
    text = sampled("sobol", base_samples=64, until=until)
    asked = text[:-1] + ', "responses": ["peak_force"]}'
    ((where, said),) = problems(asked)
    assert where == "sampling.until.responses.0"
    assert "choose from peak_force" in said
    assert read(text).sampling.until.responses == ("contact_duration",)


def test_the_indices_must_be_asked_for(problems, sampled):
    text = sampled("sobol", base_samples=64, until=UNTIL)
    text = text[:-1] + ', "analyses": ["convergence_in_nodes"]}'
    assert "sampling.until" in {key for key, _ in problems(text)}
