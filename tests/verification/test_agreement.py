"""Agreement with 3-D: what misses the target is marked, and the few exceptions are named."""

import importlib
from pathlib import Path

import pandas as pd
import pytest

import impactlab as il

pytestmark = pytest.mark.filterwarnings(
    "ignore::impactlab.TooShortWarning", "ignore::impactlab.ImplausibleWarning"
)

TESTS = Path(__file__).parents[1]
DOCS = TESTS.parent / "docs"
TABLE = pd.read_csv(DOCS / "agreement_metals.csv", index_col="case")
TARGET = {
    "peak_force": 2.0,
    "contact_duration": 2.0,
    "impulse": 2.0,
    "maximum_indentation": 2.0,
    "permanent_indentation": 3.0,
    "force_history": 5.0,
}
"""Largest difference from 3-D in %."""
EXCEPTIONS = {("design 33", "permanent_indentation"): 4.0}
"""Misses without a mark, and their limits in %: a dent in a deep beam, which still bends where its
3-D run ends."""


@pytest.fixture(scope="module")
def metals():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(TESTS / "benchmarks")
        yield importlib.import_module("metals")


def test_cases_have_the_marks_of_the_table(metals):
    grid = il.Discretisation(nodes=101)
    for name, impact in (*metals.chosen(), *metals.designed()):
        run = il.simulate(impact, grid, duration=2e-3)
        marks = metals.marks(run)
        if name in TABLE.index:
            assert marks == TABLE.marks.fillna("")[name], name
        else:
            assert marks, name


@pytest.mark.parametrize("table", ["agreement.csv", "agreement_places.csv"])
def test_beams_of_the_paper_and_near_it_meet_the_target(table):
    rows = pd.read_csv(DOCS / table).query("model == 'all'")
    for response, limit in TARGET.items():
        assert not (rows[response].abs() > limit).any(), response


def test_cases_without_a_mark_meet_the_target():
    narrow = pd.read_csv(DOCS / "agreement_large_contacts.csv").query("marked != 'yes'")
    assert (narrow[["peak force", "largest indentation"]].abs() <= 2.0).all(axis=None)
    unmarked = TABLE[TABLE.marks.isna()]
    misses = {
        (case, response)
        for response, limit in TARGET.items()
        for case in unmarked.index[unmarked[response].abs() > limit]
    }
    assert misses == EXCEPTIONS.keys()
    for case, response in misses:
        assert abs(TABLE.loc[case, response]) < EXCEPTIONS[case, response]
