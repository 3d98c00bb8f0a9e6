"""Agreement with 3-D: what misses the target is marked, and the few exceptions are named."""

import importlib
from pathlib import Path

import pandas as pd
import pytest

import impactlab as il

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

TESTS = Path(__file__).parents[1]
TABLE = pd.read_csv(TESTS.parent / "docs" / "agreement_metals.csv", index_col="case")
TARGET = {
    "peak_force": 2.0,
    "contact_duration": 2.0,
    "impulse": 2.0,
    "maximum_indentation": 2.0,
    "permanent_indentation": 3.0,
    "force_history": 5.0,
}
"""Largest difference from 3-D in %."""
EXCEPTIONS = {
    ("kinematic hardening 5 GPa", "peak_force"),
    ("kinematic hardening 5 GPa", "contact_duration"),
    ("tungsten carbide sphere", "peak_force"),
    ("design 1", "peak_force"),
    ("design 2", "contact_duration"),
}
"""Misses without a mark, by less than the 1.5 % by which the force of one 3-D mesh waves."""


@pytest.fixture(scope="module")
def metals():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(TESTS / "benchmarks")
        yield importlib.import_module("metals")


def test_cases_have_the_marks_of_the_table(metals):
    grid = il.Discretisation(nodes=101)
    for name, impact in (*metals.chosen(), *metals.designed()):
        run = il.simulate(impact, grid, duration=2e-3)
        marks = TABLE.marks.fillna("")[name]
        assert metals.marks(run) == marks, name


def test_cases_without_a_mark_meet_the_target():
    unmarked = TABLE[TABLE.marks.isna()]
    misses = {
        (case, response)
        for response, limit in TARGET.items()
        for case in unmarked.index[unmarked[response].abs() > limit]
    }
    assert misses == EXCEPTIONS
    for case, response in misses:
        assert abs(TABLE.loc[case, response]) < TARGET[response] + 1.5
