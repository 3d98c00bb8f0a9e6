"""Columns in the model's fields: checked by the rules for numbers, run for run."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import impactlab as il
from impactlab.model.checks import Column, column

NAN = float("nan")


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


@pytest.mark.parametrize(
    "values", [["a", "bc"], np.array(["a", "bc"]), np.array(["a", "bc"], dtype=object)], ids=repr
)
def test_words_stay_words(values):
    assert column(values).tolist() == ["a", "bc"]


@pytest.mark.parametrize(
    "values",
    [
        [True, 1.0],
        [np.True_, 1.0],
        np.array([True, False]),
        np.array([True, 1.0], dtype=object),
        [1.0, None],
        [1.0, [2.0]],
        [[1.0], [2.0]],
        [1j],
        [Fraction(1, 2)],
        [10**400],
    ],
    ids=repr,
)
def test_anything_else_is_no_column(values):
    with pytest.raises(ValueError, match=r"."):
        column(values)


def test_a_number_among_words_is_a_word():
    with pytest.raises(ValueError, match=r"^Impact\.velocity"):
        replace(il.paper_impact(), velocity=column(["1.0", 2.0]))


def test_a_rule_holds_for_all_of_a_column():
    sphere = il.paper_impact().sphere
    with pytest.raises(ValueError, match=r"^Sphere\.radius = .*: must be above zero$"):
        replace(sphere, radius=column([1.0, -1.0]))
    replace(sphere, radius=column([1.0, 2.0]))
    replace(sphere, radius=column([]))


def test_other_arrays_are_no_numbers():
    """A user's array in a field is a mistake, and refused as before."""
    with pytest.raises(ValueError, match=r"^Beam\.span = array.*: must be a finite number$"):
        replace(il.paper_impact().beam, span=np.array([1.0, 2.0]))


def test_fields_are_compared_run_by_run():
    beam = il.paper_impact().beam
    deep = replace(beam, span=column([0.5, 2.0]), depth=column([0.4, 1.0]))
    assert deep.depth.tolist() == [0.4, 1.0]
    with pytest.raises(ValueError, match=r"^Beam\.depth = .*: must be below the span"):
        replace(beam, span=column([0.5, 2.0]), depth=column([0.6, 1.0]))


def test_the_mass_is_that_of_each_sphere():
    sphere = il.paper_impact().sphere
    radii = np.random.default_rng(1).uniform(0.001, 0.1, 1000).tolist()
    masses = replace(sphere, radius=column(radii)).total_mass
    assert masses.tolist() == [replace(sphere, radius=radius).total_mass for radius in radii]
