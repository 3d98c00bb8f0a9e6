from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Finding, absolute, relative
from impactlab.verification.outcome import Outcome, gravest_first
from impactlab.verification.running import run


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
    entry = absolute("a", "b", "1", error, 0.0, tolerance)
    assert entry.ratio == pytest.approx(ratio)
    assert entry.passed is passed
    assert (entry.ratio <= 1) is passed


def outcome(*values, reason=""):
    entries = [relative("a", f"{value}", "1", value, 1.0, 0.1) for value in values]
    return Outcome("name", "title", "source", 0.0, Finding(entries), reason)


def test_verdicts():
    assert outcome(1.0, 1.05).verdict == "passed"
    assert outcome(1.0, 2.0).verdict == "failed"
    assert outcome().verdict == "failed"
    assert outcome(reason="no").verdict == "error"


def test_failures_and_the_worst_come_first():
    found = outcome(1.0, 1.5, np.nan, 0.2)
    assert [entry.where for entry in found.failures] == ["nan", "0.2", "1.5"]
    assert found.worst is not None
    assert found.worst.where == "nan"
    assert outcome().worst is None


def test_gravest_first_keeps_the_order_otherwise(outcomes):
    assert [found.name for found in gravest_first(outcomes)] == ["broken", "bad", "void", "good"]


def test_a_check_that_raises_is_an_outcome(monkeypatch):
    def check():
        return 1 / 0

    file = SimpleNamespace(TITLE="A title", SOURCE="a source", check=check)
    monkeypatch.setitem(CATALOGUE, "made_up", file)
    found = run("made_up")
    assert (found.name, found.title, found.source) == ("made_up", "A title", "a source")
    assert found.verdict == "error"
    assert "ZeroDivisionError" in found.reason
    assert "test_outcome.py, line" in found.reason


def test_ctrl_c_is_no_outcome(monkeypatch):
    def check():
        raise KeyboardInterrupt

    monkeypatch.setitem(CATALOGUE, "made_up", SimpleNamespace(TITLE="", SOURCE="", check=check))
    with pytest.raises(KeyboardInterrupt):
        run("made_up")
