"""The checks that the model classes share."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from impactlab.model.checks import integer, not_negative, number, one_of, positive

NAN, INFINITE = float("nan"), float("inf")
NOT_NUMBERS = [None, "1", True, NAN, INFINITE, -INFINITE, [1.0], 1j, np.array([1.0])]


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=repr)
@pytest.mark.parametrize("check", [number, positive, not_negative])
def test_what_is_not_a_finite_number_is_refused(check, value):
    with pytest.raises(ValueError, match=r"^Owner\.field = .*: must be a finite number$"):
        check("Owner", "field", value)


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int64(2), Fraction(4, 2)], ids=repr)
@pytest.mark.parametrize("check", [number, positive, not_negative])
def test_numbers_of_any_kind_become_floats(check, value):
    result = check("Owner", "field", value)
    assert result == 2.0
    assert type(result) is float


def test_zero_is_not_negative_and_not_positive():
    assert not_negative("Owner", "field", 0) == 0
    with pytest.raises(ValueError, match=r"^Owner\.field = 0: must be above zero$"):
        positive("Owner", "field", 0)
    with pytest.raises(ValueError, match=r"^Owner\.field = -1: must not be negative$"):
        not_negative("Owner", "field", -1)


@pytest.mark.parametrize("value", [5, 5.0, np.int64(5), np.float64(5)], ids=repr)
def test_whole_numbers_become_ints(value):
    result = integer("Owner", "field", value, 5)
    assert result == 5
    assert type(result) is int


@pytest.mark.parametrize("value", [4, 5.5, "5", None, INFINITE, NAN], ids=repr)
def test_other_numbers_are_refused(value):
    message = r"^Owner\.field = .*: must be a whole number of at least 5$"
    with pytest.raises(ValueError, match=message):
        integer("Owner", "field", value, 5)


def test_a_truth_is_no_count():
    with pytest.raises(ValueError, match=r"^Owner\.field = True: must be a whole number"):
        integer("Owner", "field", True, 1)


def test_a_name_is_one_of_the_choices():
    assert one_of("Owner", "field", "b", ("a", "b")) == "b"
    for value in ("c", "", None, "A", ["a"]):
        with pytest.raises(ValueError, match=r"^Owner\.field = .*: must be one of a, b$"):
            one_of("Owner", "field", value, ("a", "b"))
