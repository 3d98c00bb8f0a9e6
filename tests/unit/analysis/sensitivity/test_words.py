"""Indices of a choice among words beside numbers, from the study to the analysis.

The model is additive, so that its indices are known: the Sobol indices in closed form, delta and
PAWN by quadrature over the distributions of its parts.
"""

import numpy as np
import pytest

import impactlab as il
from impactlab.analysis import sensitivity
from impactlab.methods.delta import deltas, first_orders

OFFSET = {"low": 0.0, "middle": 1.0, "high": 3.0}
WEIGHTS = np.array([0.6, 0.3, 0.1])
SLOPES = (2.0, 3.0)
LAW = il.Choice(list(OFFSET), weights=[6, 3, 1])
UNIFORM = il.Uniform(0, 1)


def additive(law, x, y):
    return OFFSET[law] + SLOPES[0] * x + SLOPES[1] * y


def shares():
    """Variances of the three terms over their sum; that of a uniform number is a twelfth."""
    offset = np.array(list(OFFSET.values()))
    variance = WEIGHTS @ offset**2 - (WEIGHTS @ offset) ** 2
    parts = np.array([variance, *(slope**2 / 12 for slope in SLOPES)])
    return parts / parts.sum()


def distributions(weights):
    """Return t, the distribution of the response at t, and that given each word, and given x."""
    t, middles = np.linspace(-1, 9, 4001), (np.arange(400) + 0.5) / 400

    def ramp(shift):  # with x known, y alone is left
        return np.clip((t - shift) / SLOPES[1], 0, 1)

    of_numbers = [
        np.mean([ramp(a + SLOPES[0] * x) for x in middles], axis=0) for a in OFFSET.values()
    ]
    of_x = [
        sum(w * ramp(a + SLOPES[0] * x) for w, a in zip(weights, OFFSET.values(), strict=True))
        for x in middles
    ]
    return t, weights @ np.array(of_numbers), np.array(of_numbers), np.array(of_x)


@pytest.fixture
def indices(tmp_path, monkeypatch):
    """Run a study and return its analysis, through the files of both."""
    monkeypatch.chdir(tmp_path)

    def found(sampling):
        study = il.Study(
            title="Words", function=additive, sampling=sampling, analysis={"resamples": 30}
        )
        study.run(workers=1)
        return study.analyse().isel(response=0)

    return found


PARAMETERS = {"law": LAW, "x": UNIFORM, "y": UNIFORM}


def test_sobol_indices_of_a_choice_with_unequal_weights(indices):
    found = indices(il.Sobol(base_samples=1024, parameters=PARAMETERS))
    for order in ("first_order", "total_order"):
        np.testing.assert_allclose(found[order], shares(), atol=0.02)
        assert (abs(found[order] - shares()) < 1.5 * found[f"{order}_interval"]).all()
    assert np.nanmax(abs(found["second_order"])) < 0.03
    assert not any(str(name).startswith("surrogate") for name in found)


def test_delta_of_a_choice(indices):
    found = indices(il.Delta(samples=800, parameters=PARAMETERS))
    t, whole, of_words, of_x = distributions(WEIGHTS)
    density = np.gradient(whole, t)
    of_law = [np.abs(np.gradient(each, t) - density) for each in of_words]
    exact = np.trapezoid(WEIGHTS @ np.array(of_law), t) / 2
    exact_x = np.mean(
        [np.trapezoid(np.abs(np.gradient(each, t) - density), t) / 2 for each in of_x]
    )
    assert abs(found["delta"][0] - exact) < found["delta_interval"][0] < 0.1
    assert abs(found["delta"][1] - exact_x) < found["delta_interval"][1]
    assert (abs(found["delta_first_order"] - shares()) < found["delta_first_order_interval"]).all()
    assert (found["delta_first_order_interval"] < 0.08).all()


def test_pawn_of_a_choice(indices):
    law = il.Choice(list(OFFSET), weights=[0.2, 0.6, 0.2])
    found = indices(il.Pawn(samples=2000, parameters=PARAMETERS | {"law": law}))
    _, whole, of_words, of_x = distributions(np.array([0.2, 0.6, 0.2]))
    apart = np.abs(of_words - whole).max(axis=1)
    # six runs in ten have the second word, so that the median over the runs is its distance
    np.testing.assert_allclose(found["pawn"][0], apart[1], atol=0.03)
    assert np.median(apart) > apart[1] + 0.1
    np.testing.assert_allclose(found["pawn_maximum"][0], apart.max(), atol=0.03)
    slides = np.abs(of_x - whole).max(axis=1).reshape(10, -1).mean(axis=1)
    np.testing.assert_allclose(found["pawn"][1], np.median(slides), atol=0.04)


def test_the_order_of_the_words_changes_nothing(indices):
    """They are no numbers: 1200 runs tell them apart, whatever their names and places."""
    place = np.random.default_rng(1).integers(3, size=1200).astype(float)
    inputs = np.column_stack([place, np.array([5.0, 2.0, 9.0])[place.astype(int)]])
    outputs = np.array([1.0, -1.0, 0.5])[place.astype(int)] + np.random.default_rng(2).random(1200)
    t, words = np.linspace(-1, 2, 200), np.ones(2, bool)
    one, other = deltas(inputs, outputs, 8, t, 0.5, words)
    np.testing.assert_allclose(one, other, rtol=1e-12)
    (one, other), _ = first_orders(inputs, outputs)
    np.testing.assert_allclose(one, other, atol=5e-3)  # but for the pairs where words meet


@pytest.mark.parametrize("method", ["morris", "fast", "regression"])
def test_methods_that_need_an_order_refuse_stored_words(drawn, method):
    """Places of words would make plausible indices."""
    runs = drawn(method, np.zeros((40, 2)), np.arange(40.0))
    choice = {"distribution": "choice", "values": ["a", "b"], "weights": [0.5, 0.5]}
    runs = runs.assign_coords(x1=("run", np.array(["a", "b"] * 20), choice))
    with pytest.raises(ValueError, match="needs an order of the values, and x1 takes words"):
        sensitivity.analysis(runs)


def test_values_of_failed_runs_are_not_supplied_over_words(drawn):
    outputs = np.where(np.arange(100) == 7, np.nan, 1.0 * np.arange(100))
    runs = drawn("pawn", np.random.default_rng(1).random((100, 2)), outputs, failed_runs="impute")
    choice = {"distribution": "choice", "values": ["a", "b"], "weights": [0.5, 0.5]}
    runs = runs.assign_coords(x1=("run", np.array(["a", "b"] * 50), choice))
    with pytest.raises(ValueError, match="no surrogate is fitted over words \\(x1\\)"):
        sensitivity.analysis(runs)
