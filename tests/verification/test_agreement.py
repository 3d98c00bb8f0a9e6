"""Agreement with 3-D: what misses the target is marked, and the few exceptions are named."""

import importlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import impactlab as il
from impactlab.variables import WARNINGS

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
EXCEPTIONS = {
    ("design 33", "permanent_indentation"): 3.5,
    ("design 60", "force_history"): 6.6,
    ("design 79", "permanent_indentation"): 3.5,
    ("narrow 11", "contact_duration"): 3.5,
    ("narrow 16", "contact_duration"): 5.0,
    ("narrow 26", "peak_force"): 2.2,
    ("narrow 37", "permanent_indentation"): 6.0,
    ("narrow 63", "contact_duration"): 2.2,
    ("deep dent 14", "permanent_indentation"): 4.0,
    ("deep dent 21", "peak_force"): 2.4,
    ("deep dent 34", "contact_duration"): 3.4,
    ("deep dent 40", "peak_force"): 2.8,
    ("deep dent 40", "contact_duration"): 2.4,
    ("deep dent 44", "maximum_indentation"): 2.6,
    ("deep dent 44", "permanent_indentation"): 3.4,
    ("deep dent 47", "contact_duration"): 3.0,
    ("deep dent 48", "maximum_indentation"): 4.4,
    ("deep dent 48", "permanent_indentation"): 4.7,
    ("reversed 14", "contact_duration"): 2.7,
    ("reversed 15", "contact_duration"): 4.3,
    ("reversed 15", "permanent_indentation"): 3.2,
    ("reversed 18", "permanent_indentation"): 5.8,
    ("reversed 20", "contact_duration"): 4.5,
    ("reversed 26", "peak_force"): 2.2,
    ("reversed 26", "contact_duration"): 4.3,
    ("reversed 26", "force_history"): 17.0,
    ("shallow 13", "permanent_indentation"): 4.1,
}
"""Misses without a mark, and their limits in %."""
LARGEST_ERRORS = {
    "narrow": {
        "peak_force": 0.82,
        "contact_duration": 1.0,
        "maximum_indentation": 0.6,
        "permanent_indentation": 1.5,
    },
    "deep dent": {
        "peak_force": 1.3,
        "contact_duration": 1.4,
        "maximum_indentation": 1.0,
        "permanent_indentation": 1.7,
    },
    "reversed": {
        "peak_force": 0.8,
        "contact_duration": 1.7,
        "maximum_indentation": 0.5,
        "permanent_indentation": 1.7,
    },
    "shallow": {
        "peak_force": 0.45,
        "contact_duration": 0.3,
        "maximum_indentation": 0.4,
        "permanent_indentation": 1.8,
    },
}
"""Root mean squares of the differences from 3-D, in %, of narrow beams, of deep dents, of contacts
that yield in reverse and of shallow dents."""
APART = "narrow 16", "contact_duration"
"""Held by its own limit: with it the durations of narrow beams would be 1.13 % off."""


@pytest.fixture(scope="module")
def metals():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(TESTS / "benchmarks")
        yield importlib.import_module("metals")


def test_cases_have_the_marks_of_the_table(metals):
    grid = il.Discretisation(nodes=101)
    for name, impact in (*metals.chosen(), *metals.designed(), *metals.solved()):
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


@pytest.mark.parametrize("kind", LARGEST_ERRORS)
def test_contacts_of_any_metal_are_as_in_3d(kind, metals):
    """One error is larger without any part of what a narrow beam's sides do to its contact.

    Or of what reversed yielding adds, or without the fit of shallow dents.
    """
    grid, responses = il.Discretisation(nodes=101), list(LARGEST_ERRORS[kind])
    differences = {}
    for name, impact in metals.solved():
        if not name.startswith(kind):
            continue
        answers = metals.SOLVED.loc[name]
        run = il.simulate(impact, grid, duration=1.1 * answers.contact_duration)
        if not metals.marks(run):
            differences[name] = run[responses].to_array("response").to_series() / answers[responses]
    errors = 100.0 * (pd.DataFrame(differences, dtype=float).T - 1.0)
    assert len(errors) > {"reversed": 30, "shallow": 12}.get(kind, 40)
    if kind == "narrow":
        assert abs(errors.loc[APART]) < EXCEPTIONS[APART]
        errors.loc[APART] = np.nan
    for response, limit in LARGEST_ERRORS[kind].items():
        assert (errors[response] ** 2).mean() ** 0.5 < limit, response


@pytest.mark.parametrize(
    ("velocity", "hardness", "marked"), [(10, 1.0, 0), (20, 1.4, 1), (20, 2, 0)]
)
def test_deep_dents_under_a_sphere_that_the_beam_outgrows_are_marked(velocity, hardness, marked):
    """At 20 m/s, 0.027 R deep, the beam has 1.1 times the flow stress of the second sphere."""
    impact = il.corrected_impact(velocity)
    metal = replace(impact.beam.material, isotropic_hardening_modulus=4e9)
    hard = replace(impact.sphere.material, yield_stress=hardness * metal.yield_stress)
    beam, sphere = replace(impact.beam, material=metal), replace(impact.sphere, material=hard)
    impact = replace(impact, beam=beam, sphere=sphere)
    run = il.simulate(impact, il.Discretisation(nodes=101), duration=0.2e-3)
    assert bool(int(run.remarks) & WARNINGS["hardening_outside_data"][0]) == marked
