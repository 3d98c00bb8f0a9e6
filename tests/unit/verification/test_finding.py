"""Comparisons, checks and their outcomes."""

import math
from pathlib import Path

import numpy as np
import pytest

from impactlab.verification import catalogue
from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import (
    Check,
    Comparison,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Outcome,
    Reference,
    gravest_first,
    spelled,
    worst,
)


def entry(where, error, tolerance):
    return Comparison("peak force", where, "N", 1.0, 1.0, error, tolerance)


def test_worst_is_nearest_to_its_own_tolerance():
    found = worst([entry("a", 0.1, 1.0), entry("b", -0.02, 0.01), entry("c", 0.3, 1.0)])
    assert found.where == "b (the worst of 3)"
    assert not found.passed
    found = worst([entry("a", 5.0, 1.0), entry("b", math.nan, 1.0)])
    assert found.where.startswith("b")
    assert not found.passed
    found = worst([entry("a", 0.0, 0.0), entry("b", 0.1, 1.0), entry("c", -1e-16, 0.0)])
    assert found.where.startswith("c")
    assert worst([entry("a", 0.0, 0.0), entry("b", 0.1, 1.0)]).where.startswith("b")


@pytest.mark.parametrize("ours", [0.0, 1e-300, 1.0, -2.0, np.nan])
def test_no_value_is_relatively_close_to_zero(ours):
    """A relative error against zero is infinite: use `absolute` there."""
    (entry,) = Comparisons("b").relative("a", "1", ours, 0.0, 1e9)
    assert entry.error == np.inf
    assert not entry.passed


@pytest.mark.parametrize(("ours", "error"), [(2.0, 0.0), (2.5, 0.25), (-2.0, -2.0), (0.0, -1.0)])
def test_relative_error_is_a_share_of_the_independent_value(ours, error):
    (entry,) = Comparisons("b").relative("a", "1", ours, 2.0, 0.3)
    assert (entry.error, entry.measure) == (error, "relative")


def test_curves_are_compared_where_they_differ_most():
    ours, independent = np.array([1.0, -2.0, 3.5]), np.array([1.0, -1.0, 4.0])
    (entry,) = Comparisons("b").curve("a", "m", ours, independent, 0.1)
    assert (entry.ours, entry.independent, entry.error) == (-2.0, -1.0, 0.25)
    (gap,) = Comparisons("b").curve("a", "m", np.array([1.0, np.nan, 4.0]), independent, 0.1)
    assert not gap.passed


@pytest.mark.parametrize(
    ("error", "tolerance", "ratio", "passed"),
    [
        (0.5, 1.0, 0.5, True),
        (-0.5, 1.0, 0.5, True),
        (1.0, 1.0, 1.0, True),
        (2.0, 1.0, 2.0, False),
        (0.0, 0.0, 0.0, True),
        (1e-16, 0.0, np.inf, False),
        (np.nan, 1.0, np.inf, False),
        (np.inf, 1.0, np.inf, False),
    ],
)
def test_ratio_is_above_one_where_it_fails(error, tolerance, ratio, passed):
    (entry,) = Comparisons("b").absolute("a", "1", error, 0.0, tolerance)
    assert entry.ratio == pytest.approx(ratio)
    assert entry.passed is passed
    assert (entry.ratio <= 1) is passed


def outcome(*values, reason=""):
    rows = [Comparisons(f"{value}").relative("a", "1", value, 1.0, 0.1) for value in values]
    entries = [entry for row in rows for entry in row]
    return Outcome("name", "title", "source", 0.0, Finding(entries), reason)


def test_verdicts(outcomes):
    assert outcome(1.0, 1.05).verdict == "passed"
    assert outcome(1.0, 2.0).verdict == "failed"
    assert outcome().verdict == "failed"
    assert outcome(reason="no").verdict == "error"
    # failures and the worst come first
    found = outcome(1.0, 1.5, np.nan, 0.2)
    assert [entry.where for entry in found.failures] == ["nan", "0.2", "1.5"]
    assert found.worst is not None
    assert found.worst.where == "nan"
    assert outcome().worst is None
    # gravest first keeps the order otherwise
    assert [found.name for found in gravest_first(outcomes)] == ["broken", "bad", "void", "good"]


def test_a_check_that_raises_is_an_outcome():
    def check():
        return 1 / 0

    found = Check("made_up", "A title", "a source", check).run()
    assert (found.name, found.title, found.source) == ("made_up", "A title", "a source")
    assert found.verdict == "error"
    assert "ZeroDivisionError" in found.reason
    assert "test_finding.py, line" in found.reason

    # ctrl c is no outcome
    def check():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Check("made_up", "", "", check).run()


def test_every_check_is_listed_by_a_name_of_its_own():
    files = Path(catalogue.__file__).parent.glob("*.py")
    assert sum(file.read_text("utf-8").count("\n@check(") for file in files) == len(CATALOGUE)
    assert all(check.title and check.source for check in CATALOGUE.values())


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("energy lost, kogut_etsion, 3 m/s", "energy lost, Kogut-Etsion, 3 m/s"),
        ("euler_bernoulli, half_space, mjg", "Euler-Bernoulli, half space, MJG"),
        ("mid-span (w_xx; psi_x)", "mid-span (w_xx; psi_x)"),
    ],
)
def test_names_of_study_files_are_spelled_as_in_papers(name, text):
    comparison = Comparison(name, name, "1", 1.0, 1.0, 0.0, 1.0)
    assert comparison.quantity == comparison.where == text
    assert Curve(name, np.zeros(1), np.zeros(1)).label == text
    assert CurvePanel(name, ("time", "s"), ("force", "N"), []).title == text
    assert spelled(text) == text, "a stored finding stays as it is"


def test_a_reference_gives_its_uncertainty_in_the_measure_of_each_comparison():
    reference = Reference("series", 1e-3, "made up", {"peak.*fast": 2e-3})
    entries = Comparisons("slow").relative("peak force", "N", 1.0, 1.0, 0.1)
    entries.at("fast").relative("peak force", "N", 1.0, 1.0, 0.1)
    entries.absolute("restitution", "1", 0.5, 0.5, 0.1).absolute("contacts", "1", 2.0, 2.0, 0.1)
    sizes = [reference.applied(entry).uncertainty for entry in entries]
    assert sizes == [1e-3, 2e-3, 0.5e-3, 0.0]
    assert all(np.isnan(Reference().applied(entry).uncertainty) for entry in entries)
    outcome = Check("made_up", "", "", lambda: Finding(entries), reference).run()
    assert [entry.uncertainty for entry in outcome.finding.comparisons] == sizes
    assert (outcome.reference, outcome.basis) == ("series", "made up")
