import re

import pytest

from impactlab.variables import RESPONSES

WRONG_IN_GRID = [
    ("title", 3, "expected text"),
    ("title", "", "one line"),
    ("title", "two\nlines", "one line"),
    ("titel", "x", "unknown key; did you mean 'title'?"),
    ("duration", "12 mm", "expected a time such as '12 ms'"),
    ("duration", 0, "must be above 0"),
    ("impact", 3, "expected a mapping"),
    ("impact.base", "papr", "did you mean 'paper'?"),
    ("impact.velocity", "0.99 kg", "expected a velocity such as '0.99 m/s'"),
    ("impact.velocity", True, "expected a velocity"),
    ("impact.velocity", None, "expected a velocity"),
    ("impact.velocity", -1, "must be above zero"),
    ("impact.contact", "herz", "unknown contact law; did you mean 'hertz'?"),
    ("impact.sphere.material.isotropic_hardening_modulus", 1, "unknown key"),
    ("impact.beam.material.yeild_stress", 1, "did you mean 'yield_stress'?"),
    ("impact.beam.material.yield_stress", "345 GPa", "must be below youngs_modulus"),
    ("impact.beam.depth", "780 mm", "must be below the span"),
    ("discretisation.nodes", 200, "must be odd"),
    ("discretisation.nodes", 20.5, "expected a whole number"),
    ("discretisation.rule", "gauss", "unknown integration rule; choose from lobatto"),
    ("sampling", [], "expected a mapping with the key method"),
    ("sampling.method", "gird", "unknown method; did you mean 'grid'?"),
    ("sampling.seed", 1, "unknown key; choose from method, parameters"),
    ("sampling.until", {}, "belongs to the section sampling with method: sobol or"),
    ("groups", {}, "groups belong to the section sampling with method: sobol or morris"),
    ("sampling.parameters", {}, "too few"),
    ("sampling.parameters.beam_dept", [1], "did you mean 'beam_depth'?"),
    ("sampling.parameters.velocity", [], "list at least one value"),
    ("sampling.parameters.velocity", 3, "expected a list such as"),
    ("sampling.parameters.velocity", ["1 m/s", 1], "holds 1.0 (in SI units) more than once"),
    ("sampling.parameters.rule", {"start": 1, "stop": 2, "number": 2}, "expected a list"),
    ("responses", [], "expected `all`, or a list of names"),
    ("responses", ["peak_force", "peak_force"], "names peak_force more than once"),
    ("store.profile", True, "did you mean 'profiles'?"),
    ("store.histories", 1, "expected true or false"),
    ("store.samples", 1, "must be at least 2"),
    ("analysis", {"confidence": 0.9}, "has no effect with method: grid"),
]
WRONG_IN_AXIS = [
    ("nodes", [11, 12], "nodes.1", "must be odd"),
    ("velocity", [1, "2 kg"], "velocity.1", "wrong dimension"),
    ("rule", ["lobato"], "rule.0", "did you mean 'lobatto'?"),
    ("gravity", {"start": 2, "stop": 1, "number": 3}, "gravity.stop", "above start (2.0)"),
    ("gravity", {"start": 1, "stop": 1, "number": 3}, "gravity.stop", "above start"),
    ("gravity", {"start": 1, "stop": 2, "number": 1}, "gravity.number", "must be at least 2"),
    ("gravity", {"start": 1, "stop": 2}, "gravity.number", "is required"),
    ("gravity", {"start": 1, "stop": 2, "number": 2, "step": 1}, "gravity.step", "unknown key"),
    (
        "gravity",
        {"start": 1, "stop": 2, "number": 2, "spacing": "logg"},
        "gravity.spacing",
        "did you mean 'log'?",
    ),
    (
        "gravity",
        {"start": 0, "stop": 2, "number": 2, "spacing": "log"},
        "gravity.start",
        "must be above zero for spacing: log",
    ),
    ("nodes", {"start": 11, "stop": 21, "number": 3}, "nodes", "the range gives 16"),
    ("points", {"start": 2, "stop": 5, "number": 3}, "points", "the range gives 3.5"),
]
WRONG_IN_SAMPLE = [
    ("base_samples", 1000, "must be a power of two, such as 512 or 1024"),
    ("base_samples", 2, "must be at least 4"),
    ("seed", -1, "must be at least 0"),
    ("seed", True, "expected a whole number"),
    ("second_order", 1, "expected true or false"),
    ("parameters.nodes", {"distribution": "uniform", "low": 5, "high": 9}, "is a whole number"),
    ("parameters.points", 3, "or vary it in a study with method: grid"),
    ("parameters.rule", ["lobatto"], "takes words: write {distribution: choice, values: [lobatto"),
    ("parameters.velocity", [1, 2], "expected a mapping with the key distribution"),
    (
        "correlations",
        [["velocity", "beam_depth", 0.5]],
        "method: latin, delta, hsic, pawn",
    ),
    ("correlation", 0.5, "Morris and FAST indices assume independent parameters"),
    ("covariance_matrix", [[1]], "give them one index together (groups)"),
    ("copula", "gauss", "vary the quantities that they depend on"),
    ("parameters.velocity.correlated_with", "beam_depth", "or fix all but one"),
]
WRONG_IN_DISTRIBUTION = [
    ({"distribution": "uniform", "low": 0.02, "high": 0.01}, "beam_depth.high", "low (20 mm)"),
    ({"distribution": "uniform", "low": 0, "high": 1}, "beam_depth.low", "must be above zero"),
    (
        {"distribution": "uniform", "low": 0.02, "high": "20 mm"},
        "beam_depth.high",
        "for a single value write {distribution: fixed, value: ...}",
    ),
    ({"distribution": "uniform", "low": 1}, "beam_depth.high", "is required"),
    ({"low": 1, "high": 2}, "beam_depth.distribution", "is required: choose from uniform"),
    ({"distribution": "normla"}, "beam_depth.distribution", "did you mean 'normal'?"),
    (
        {"distribution": "uniform", "low": "20 kg", "high": 1},
        "beam_depth.low",
        "expected a length such as '27.8 mm'",
    ),
    (
        {"distribution": "normal", "mean": 1, "standard_deviation": 1, "low": 0},
        "beam_depth.low",
        "unknown key; choose from distribution, mean, standard_deviation",
    ),
]


PARAMETERS = "sampling.parameters"
MISTAKES = [
    *(("grid", {key: value}, key, words) for key, value, words in WRONG_IN_GRID),
    *(
        ("grid", {PARAMETERS: {name: values}}, f"{PARAMETERS}.{key}", words)
        for name, values, key, words in WRONG_IN_AXIS
    ),
    *(
        ("sample", {f"sampling.{key}": value}, f"sampling.{key}", words)
        for key, value, words in WRONG_IN_SAMPLE
    ),
    *(
        ("sample", {f"{PARAMETERS}.beam_depth": depth}, f"{PARAMETERS}.{key}", words)
        for depth, key, words in WRONG_IN_DISTRIBUTION
    ),
]


@pytest.mark.parametrize(("kind", "changes", "key", "words"), MISTAKES)
def test_one_mistake_is_one_problem_at_its_key(refused, request, kind, changes, key, words):
    line = refused(request.getfixturevalue(kind)(changes), key, words)
    assert re.search(rf"some-study_1\.yaml: {re.escape(key)}( = .*)?: ", line)


def test_the_value_is_shown_as_it_stands_in_the_file(refused, grid):
    key = "impact.velocity"
    for value, shown in (("0.99 kg", "'0.99 kg'"), (None, "null")):
        refused(grid({key: value}), key, f"{key} = {shown}: ")
    assert len(refused(grid({key: "9" * 5000}), key)) < 300


def test_an_unknown_response_is_named_with_the_nearest_and_all_choices(refused, grid):
    text = grid({"responses": ["peak_force", "contact_durations"]})
    refused(text, "responses.1", "did you mean 'contact_duration'?", *RESPONSES)


def test_without_a_base_all_that_is_missing_is_named_at_once(refused, grid):
    said = refused(grid({"impact": {"velocity": 1, "beam": {"span": 1}}}), "impact")
    named = set(said.partition("required too: ")[2].split(", "))
    material = {"density", "youngs_modulus", "poissons_ratio", "yield_stress"}
    assert named == (
        {"sphere.radius", "beam.width", "beam.depth"}
        | {f"{body}.material.{field}" for body in ("sphere", "beam") for field in material}
    )


def test_keys_that_are_no_words_are_named(problems, grid):
    found = dict(problems(grid() + "3: 4\n4.5: 5\n"))
    assert found.keys() == {"3", "4.5"}
    assert all("a key must be a word" in said for said in found.values())


@pytest.mark.parametrize("title", [r'"\e[31mred"', r'"\ud800"'])
def test_text_that_cannot_be_printed_is_refused(refused, grid, title):
    assert refused(grid().replace("A grid", title), "title").isprintable()


def test_all_problems_of_a_file_come_at_once(problems, sample):
    wrong = {
        "titel": "x",
        "impact.gravity": "1 m",
        "impact.beam.depth": -1,
        "discretisation.nodes": 200,
        "discretisation.rule": "gauss",
        "sampling.base_samples": 3,
        "sampling.parameters.velocity.low": "1 kg",
        "sampling.parameters.rule": 3,
        "responses": "peek_force",
        "store.profile": True,
    }
    found = problems(sample(wrong))
    assert len(found) == len(wrong)
    assert {key for key, _ in found} == wrong.keys()
