"""A choice among words in a study of impacts: from its section to runs and pilot runs."""

import json
from collections import Counter
from itertools import combinations

import numpy as np
import pytest

import impactlab as il
from impactlab.api.folder import StudyFolder
from impactlab.study.adaptive.recommendation import corner_cases
from impactlab.study.estimate import estimate
from impactlab.study.schema.readers import study_of_text
from impactlab.validation.errors import StudyError

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

LAWS = ["stronge", "mjg", "thornton"]
CHOICE = {"distribution": "choice", "values": LAWS, "weights": [2, 1, 1]}
OWN = {"sobol": {"base_samples": 64}, "delta": {"samples": 400}, "pawn": {"samples": 400}}
WRONG = [
    ({"values": ["mjg", "strong"]}, "values.1", "did you mean 'stronge'?"),
    ({"values": ["mjg", 3]}, "values.1", "choose from"),
    ({"values": ["mjg", "hertz", "mjg"]}, "values", "names mjg more than once"),
    ({"values": ["mjg"]}, "values", "write {distribution: fixed, value: ...}"),
    ({"values": "mjg"}, "values", "list"),
    ({}, "values", "is required"),
    ({"values": LAWS, "weights": [1, 1]}, "weights", "holds 2 for 3 words"),
    ({"values": LAWS, "weights": [1, 0, 1]}, "weights.1", "must be above 0"),
    ({"values": LAWS, "weights": [1, -1, 1]}, "weights.1", "must be above 0"),
    ({"values": LAWS, "weights": [1, ".inf", 1]}, "weights.1", ""),
    ({"values": LAWS, "weight": [1, 1, 1]}, "weight", "did you mean 'weights'?"),
]


@pytest.fixture
def text():
    """The text of a study that draws a contact law, and others as given."""

    def made(method="sobol", contact=CHOICE, *, study=None, parameters=None, **others):
        speed = {"distribution": "uniform", "low": 1, "high": 2}
        given = {"contact": contact, "velocity": speed} | (parameters or {})
        section = {"method": method, "parameters": given} | OWN.get(method, {}) | others
        whole = {"title": "-", "impact": {"base": "paper"}, "duration": 5e-4, "sampling": section}
        whole |= {"discretisation": {"nodes": 11, "points": 3}, "responses": ["peak_force"]}
        return json.dumps(whole | (study or {}))

    return made


@pytest.fixture
def problems():
    def found(text):
        with pytest.raises(StudyError) as error:
            study_of_text("some", text)
        return [(each.key, str(each)) for each in error.value.args]

    return found


@pytest.mark.parametrize("method", OWN)
def test_words_are_drawn_by_their_weights(designed, text, method):
    drawn = designed(text(method))["contact"]
    assert drawn.dims == ("run",)
    assert drawn.attrs["values"] == LAWS
    np.testing.assert_allclose(drawn.attrs["weights"], [0.5, 0.25, 0.25])
    share = {word: number / drawn.size for word, number in Counter(drawn.values.tolist()).items()}
    # an even sample meets the weights to a few runs in each of its columns
    assert share == pytest.approx({"stronge": 0.5, "mjg": 0.25, "thornton": 0.25}, abs=0.005)


def test_without_weights_all_words_are_as_likely(designed, text):
    drawn = designed(text("pawn", {"distribution": "choice", "values": ["mjg", "stronge"]}))
    assert Counter(drawn["contact"].values.tolist()) == {"mjg": 200, "stronge": 200}


@pytest.mark.parametrize(("given", "key", "words"), WRONG)
def test_a_mistake_in_a_choice_is_one_problem_at_its_key(problems, text, given, key, words):
    ((where, said),) = problems(text(contact={"distribution": "choice"} | given))
    assert where == f"sampling.parameters.contact.{key}"
    assert words in said


@pytest.mark.parametrize(
    ("method", "own"),
    [("morris", {"trajectories": 4}), ("fast", {"samples": 1188}), ("regression", {"samples": 64})],
)
def test_methods_that_need_an_order_refuse_words(problems, text, method, own):
    ((where, said),) = problems(text(method, **own))
    assert where == "sampling.parameters.contact.distribution"
    assert f"method {method}" in said
    assert "words have no order: use method sobol, delta or pawn" in said


@pytest.mark.parametrize(
    ("given", "key", "words"),
    [
        ({"study": {"analyses": ["surrogate"]}}, "analyses", "words, which have no order"),
        (
            {"study": {"analysis": {"failed_runs": "impute"}}},
            "analysis.failed_runs",
            "no surrogate",
        ),
        ({"method": "delta", "samples": 79}, "sampling.parameters.contact", "raise samples to 80"),
        (
            {"parameters": {"velocity": CHOICE}},
            "sampling.parameters.velocity.distribution",
            "is for words, and this is a number",
        ),
        (
            {"parameters": {"points": CHOICE}},
            "sampling.parameters.points",
            "is a whole number: write {distribution: integers",
        ),
        (
            {"parameters": {"beam_model": CHOICE | {"values": ["rigid", "solid", "elastic"]}}},
            "discretisation.element_size",
            "is required for beam_model: solid",
        ),
        (
            {
                "parameters": {
                    "beam_model": CHOICE | {"values": ["rigid", "timoshenko", "elastic"]},
                    "load": {"distribution": "choice", "values": ["point", "contact_patch"]},
                }
            },
            "sampling.parameters.load",
            "contact_patch is not for rigid",
        ),
    ],
)
def test_refused_beside_words(problems, text, given, key, words):
    assert words in dict(problems(text(**given)))[key]


def test_runs_are_those_of_the_words(text, tmp_path):
    """Against the same impacts one by one, and stored words against drawn ones."""
    models = {"distribution": "choice", "values": ["euler_bernoulli", "timoshenko"]}
    study = StudyFolder(
        study_of_text("some", text("pawn", parameters={"beam_model": models}, samples=100)),
        tmp_path,
    )
    runs, drawn = study.run(workers=1), study.design()
    names = ["contact", "beam_model", "velocity"]
    for name in names:
        np.testing.assert_array_equal(runs[name].values, drawn[name].values)
    again = il.simulate_many(
        il.paper_impact(),
        study.declared.discretisation,
        duration=study.declared.duration,
        varied={name: drawn[name].values[:20] for name in names},
    )
    np.testing.assert_array_equal(runs.peak_force[:20], again.peak_force)
    assert np.unique(runs.peak_force).size == 100


def test_pilot_runs_and_costs_know_every_word(text, tmp_path):
    study = study_of_text(
        "some",
        text(
            parameters={"beam_model": CHOICE | {"values": ["elastic", "timoshenko", "spring_mass"]}}
        ),
    )
    cases = corner_cases(study)
    for one, other in combinations(("contact", "beam_model", "velocity"), 2):
        assert len({*zip(cases[one], cases[other], strict=True)}) == len(cases[one]) == 3 * 3
    assert estimate(study, tmp_path, 1).largest_run["beam_model"] == "spring_mass"


def test_words_of_a_function_need_be_no_law():
    def model(kind, x):
        return x

    def study(values):
        given = {"kind": il.Choice(values), "x": il.Uniform(0, 1)}
        return il.Study(title="-", function=model, sampling=il.Delta(samples=64, parameters=given))

    assert study(["soft", "hard"]).design()["kind"].attrs["values"] == ["soft", "hard"]
    with pytest.raises(StudyError, match=r"kind\.values\.1 = '=1': is no word"):
        study(["soft", "=1"])
    given = {"x1": il.Choice(["a", "b"]), "x2": il.Uniform(0, 1)}
    with pytest.raises(StudyError, match="is for words, and this is a number"):
        il.Study(title="-", function="ishigami", sampling=il.Delta(samples=64, parameters=given))
