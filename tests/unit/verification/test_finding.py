"""The comparison that stands for many."""

import math

from impactlab.verification.finding import Comparison, worst


def entry(where, error, tolerance):
    return Comparison("peak force", where, "N", 1.0, 1.0, error, tolerance)


def test_worst_is_nearest_to_its_own_tolerance():
    found = worst([entry("a", 0.1, 1.0), entry("b", -0.02, 0.01), entry("c", 0.3, 1.0)])
    assert found.where == "b (the worst of 3)"
    assert not found.passed


def test_a_missing_number_is_the_worst():
    found = worst([entry("a", 5.0, 1.0), entry("b", math.nan, 1.0)])
    assert found.where.startswith("b")
    assert not found.passed


def test_a_tolerance_of_zero_is_one():
    found = worst([entry("a", 0.0, 0.0), entry("b", 0.1, 1.0), entry("c", -1e-16, 0.0)])
    assert found.where.startswith("c")
    assert worst([entry("a", 0.0, 0.0), entry("b", 0.1, 1.0)]).where.startswith("b")
