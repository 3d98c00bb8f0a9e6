"""Runs of a table that was made elsewhere."""

import re

import numpy as np
import pytest

import impactlab as il

ROWS = 256


def _table(rng):
    """Return two normal inputs, correlated by 0.6, and a line over them."""
    covariance = np.array([[1.0, 0.6], [0.6, 1.0]])
    normal = rng.multivariate_normal([0, 0], covariance, ROWS)
    return {"a": normal[:, 0], "b": normal[:, 1]}, {"y": normal @ [1.0, 0.5]}


@pytest.fixture
def table():
    return _table(np.random.default_rng(3))


def test_first_orders_of_correlated_inputs_are_those_of_the_line(table):
    """Var(E[Y|X]) of a Gaussian line is the square of its covariance with X: 1.3^2 and 1.1^2."""
    runs = il.runs_of_table(*table, indices=["rbd_fast", "delta"])
    found = il.analyse(runs).isel(response=0)
    exact = np.array([1.3, 1.1]) ** 2 / (1 + 0.25 + 0.6)
    for name in ("first_order", "delta_first_order"):
        assert (abs(found[name] - exact) < found[f"{name}_interval"]).all()
        assert (found[f"{name}_interval"] < 0.15).all()
    assert "correlated (a and b)" in il.answers(runs, il.analyse(runs))[0]
    assert {"a", "b"} == {name for entry in runs.attrs["correlated"] for name in entry.split()}


def test_rows_in_the_order_of_one_input_do_not_give_its_share_to_another():
    """Equal values of the other input lie side by side, in the order of the rows."""
    first, second = (column.ravel() for column in np.mgrid[:20, :20].astype(float))
    runs = il.runs_of_table({"a": first, "b": second}, {"y": first}, indices="delta")
    found = il.analyse(runs).isel(response=0)
    np.testing.assert_allclose(found["delta_first_order"], [1, 0], atol=0.15)
    np.testing.assert_array_equal(runs["a"], first[runs["row"]])
    assert "correlated" not in runs.attrs


def test_words_are_classes_and_a_missing_output_has_no_index(table):
    inputs, outputs = table
    law = np.where(np.arange(ROWS) % 4, "hertz", "mjg")
    outputs = {"y": 2.0 * (law == "mjg") + 0.1 * inputs["a"], "gap": outputs["y"].copy()}
    outputs["gap"][7] = np.nan
    runs = il.runs_of_table(inputs | {"law": law}, outputs, indices=["delta", "pawn"])
    found = il.analyse(runs)
    share = 4 * 0.1875 / (4 * 0.1875 + 0.01)
    y = found.sel(response="y", parameter="law")
    assert abs(y["delta_first_order"] - share) < 0.02
    np.testing.assert_allclose(y["pawn_maximum"], 0.75, atol=0.02)  # of the rarer word
    assert np.isnan(found["delta"].sel(response="gap")).all()
    assert any("gap (1 of 256)" in sentence for sentence in il.answers(runs, found))


FEW = {"a": np.arange(ROWS) % 3 * 1.0}
MISTAKES = {
    "no inputs": ({}, {}, {}, "inputs has no columns"),
    "lengths": ({"c": np.zeros(9)}, {}, {}, "c has 9 rows and a has 256"),
    "missing input": ({"a": np.full(ROWS, np.nan)}, {}, {}, "a holds a value that is no finite"),
    "constant": ({"a": np.ones(ROWS)}, {}, {}, "a holds one value alone"),
    "few values": (FEW, {}, {}, "give it as words"),
    "rare word": ({"a": ["x"] * 250 + ["y"] * 6}, {}, {}, "'y' in 6 rows, and 20 are needed"),
    "words": ({"a": ["x", "y"] * 128}, {}, {"indices": "rbd_fast"}, "words, which have no order"),
    "mixed": ({"a": np.array(["x", None] * 128)}, {}, {}, "holds None among words"),
    "index": ({}, {}, {"indices": "sobol"}, "unknown index of given data"),
    "target": ({}, {}, {"indices": "target_hsic"}, "target_hsic needs `limits`"),
    "no target": ({}, {}, {"limits": {"y": 1}}, "limits are for target_hsic: list it"),
    "limit": (
        {},
        {},
        {"indices": "target_hsic", "limits": {"z": 1}},
        "limits: 'z' unknown response",
    ),
    "name": ({"run": np.zeros(ROWS)}, {}, {}, "'run' cannot name a column"),
    "both": ({}, {"a": np.zeros(ROWS)}, {}, "a names an input, too"),
    "text": ({}, {"y": ["p"] * ROWS}, {}, "y holds no numbers"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_a_table_that_does_not_suit_the_indices_is_refused(table, case):
    inputs, outputs, options, words = MISTAKES[case]
    given = {} if case == "no inputs" else table[0] | inputs
    with pytest.raises(ValueError, match=words):
        il.runs_of_table(given, table[1] | outputs, **options)


def test_too_few_rows_are_refused(table):
    few = [{name: values[:50] for name, values in part.items()} for part in table]
    with pytest.raises(ValueError, match="50 rows are too few for delta: give 64 or more"):
        il.runs_of_table(*few)


def test_a_small_table_tells_the_first_input_where_intervals_separate_it():
    rng = np.random.default_rng(1)
    inputs = {name: rng.uniform(0, 1, 80) for name in ("a", "b", "c")}
    dominant = {"y": 6 * inputs["a"] + inputs["b"] + 0.5 * inputs["c"]}
    equal = {"y": inputs["a"] + inputs["b"] + 0.5 * inputs["c"]}
    options = {"indices": "rbd_fast", "seed": 2}
    first, doubt = il.answers(il.runs_of_table(inputs, dominant, **options))
    assert re.fullmatch(
        r"a \([\d.]+ ± [\d.]+ %\) matters most for the y; intervals are too wide for the other "
        r"ranks\.",
        first,
    )
    assert doubt == "Do not rely on the indices of: y (wide intervals)."
    first, *_ = il.answers(il.runs_of_table(inputs, equal, **options))
    assert first == "No sensitivity index of this study is usable."
    lines = il.answers(il.runs_of_table(inputs, {"x": dominant["y"], "z": equal["y"]}, **options))
    assert "matters most for the x" in lines[0]
    assert lines[1] == "Do not rely on the indices of: x (wide intervals), z (wide intervals)."
