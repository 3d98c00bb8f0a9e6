"""The checks that the model classes share, of numbers and of columns."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import impactlab as il
from impactlab.model.checks import Column, column, integer, number, one_of, positive

NAN, INFINITE = float("nan"), float("inf")


@pytest.mark.parametrize("check", [number, positive])
def test_numbers_of_any_kind_become_floats_and_others_are_refused(check):
    for value in (2, 2.0, np.float32(2), np.int64(2), Fraction(4, 2)):
        assert repr(check("Owner", "field", value)) == "2.0"
    for value in (None, "1", True, NAN, INFINITE, -INFINITE, [1.0], 1j, np.array([1.0])):
        with pytest.raises(ValueError, match=r"^Owner\.field = .*: must be a finite number$"):
            check("Owner", "field", value)
    assert number("Owner", "field", 0) == 0.0
    with pytest.raises(ValueError, match=r"^Owner\.field = 0: must be above zero$"):
        positive("Owner", "field", 0)


def test_whole_numbers_become_ints_and_others_are_refused():
    for value in (5, 5.0, np.int64(5), np.float64(5)):
        assert repr(integer("Owner", "field", value, 5)) == "5"
    for value in (4, 5.5, "5", None, True, INFINITE, NAN):
        with pytest.raises(ValueError, match=r"^Owner\.field = .*: must be a whole number"):
            integer("Owner", "field", value, 5)


def test_a_name_is_one_of_the_choices():
    assert one_of("Owner", "field", "b", ("a", "b")) == "b"
    for value in ("c", "", None, "A", ["a"]):
        with pytest.raises(ValueError, match=r"^Owner\.field = .*: must be one of a, b$"):
            one_of("Owner", "field", value, ("a", "b"))
    with pytest.raises(ValueError, match=r"must be one of hertz, mjg; did you mean 'hertz'\?$"):
        one_of("Owner", "field", "herz", ("hertz", "mjg"))


# Columns in the model's fields: checked by the rules for numbers, run for run


@pytest.mark.parametrize(
    "values",
    [
        [1, 2.5],
        (np.float32(1), np.int8(2)),
        np.array([1, 2], dtype=np.uint8),
        np.array([1.0, 2.5], dtype=np.float32),
        np.array([1, 2.5], dtype=object),
        [],
    ],
    ids=repr,
)
def test_numbers_become_floats(values):
    made = column(values)
    assert isinstance(made, Column)
    assert made.dtype == np.float64
    assert made.tolist() == [float(value) for value in values]


def test_words_stay_words_and_anything_else_is_no_column():
    for words in (["a", "bc"], np.array(["a", "bc"]), np.array(["a", "bc"], dtype=object)):
        assert column(words).tolist() == ["a", "bc"]
    truths = [[True, 1.0], [np.True_, 1.0], np.array([True, False]), np.array([True, 1.0], object)]
    others = [[1.0, None], [1.0, [2.0]], [[1.0], [2.0]], [1j], [Fraction(1, 2)], [10**400]]
    for values in (*truths, *others):
        with pytest.raises(ValueError, match=r"."):
            column(values)


def test_columns_in_fields_are_checked_run_by_run_and_other_arrays_refused():
    """A user's array in a field is a mistake, and refused as before."""
    with pytest.raises(ValueError, match=r"^Beam\.span = array.*: must be a finite number$"):
        replace(il.paper_impact().beam, span=np.array([1.0, 2.0]))
    # a number among words is a word
    with pytest.raises(ValueError, match=r"^Impact\.velocity"):
        replace(il.paper_impact(), velocity=column(["1.0", 2.0]))
    # a rule holds for all of a column
    sphere = il.paper_impact().sphere
    with pytest.raises(ValueError, match=r"^Sphere\.radius = .*: must be above zero$"):
        replace(sphere, radius=column([1.0, -1.0]))
    replace(sphere, radius=column([1.0, 2.0]))
    replace(sphere, radius=column([]))
    # fields are compared run by run
    beam = il.paper_impact().beam
    deep = replace(beam, span=column([0.5, 2.0]), depth=column([0.4, 1.0]))
    assert deep.depth.tolist() == [0.4, 1.0]
    with pytest.raises(ValueError, match=r"^Beam\.depth = .*: must be below the span"):
        replace(beam, span=column([0.5, 2.0]), depth=column([0.6, 1.0]))
    # the mass is that of each sphere
    radii = np.random.default_rng(1).uniform(0.001, 0.1, 1000).tolist()
    masses = replace(sphere, radius=column(radii)).total_mass
    assert masses.tolist() == [replace(sphere, radius=radius).total_mass for radius in radii]
