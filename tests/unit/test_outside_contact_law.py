"""A run beyond the range of its contact law keeps its answers, and is marked wherever it shows."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.figures import access
from impactlab.methods.runs import usable
from impactlab.report.cautions import cautions
from impactlab.report.console import print_responses
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.switch import limit
from impactlab.variables import FAILED, MARKS, RESPONSES
from impactlab.verification.cases import rigid_backed
from impactlab.verification.solutions import hertz

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

BIT, WORDS = MARKS["outside_contact_law"]
GRID = il.Discretisation(nodes=21, points=3)


def at(velocity, law="kogut_etsion"):
    return il.simulate(il.paper_impact(velocity, law), GRID, duration=20e-3, samples=2)


def limit_of(law, impact):
    material = impact.beam.material
    pair = hertz.effective_modulus(impact), impact.sphere.radius, material.yield_stress
    return limit(LAWS.index(law), *pair, material.poissons_ratio)


@pytest.mark.parametrize("velocity", [2.0, 5.0])
def test_marked_exactly_where_the_indentation_is_beyond_the_limit(velocity):
    run = at(velocity)
    beyond = run.maximum_indentation.item() > limit_of("kogut_etsion", il.paper_impact())
    assert beyond == (velocity == 5.0)
    assert bool(run.status.item() & BIT) == beyond
    assert all(np.isfinite(run[name].item()) for name in RESPONSES)


@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
@pytest.mark.parametrize("law", LAWS)
def test_every_law_ends_somewhere(law):
    """A velocity at which even Hertz's law, or a damper, would have its sphere in the beam."""
    impact = replace(rigid_backed(2000.0, law), gravity=0.0)
    if law == "hunt_crossley":  # stops any sphere of steel
        impact = replace(impact, sphere=replace(impact.sphere, mass=1e3))
    run = il.simulate(impact, GRID, duration=1e-4, samples=2)
    assert run.status.item() & BIT


@pytest.fixture
def runs():
    velocity = np.array([2.0, 5.0, 5.0])
    contact = np.array(["kogut_etsion", "kogut_etsion", "hertz"])
    many = il.simulate_many(
        il.paper_impact(), GRID, duration=20e-3, varied={"velocity": velocity, "contact": contact}
    )
    return many.assign_attrs(responses=list(RESPONSES), varied=["velocity", "contact"])


def test_it_is_no_failure(runs):
    assert (runs.status.values & BIT).tolist() == [0, BIT, 0]
    assert not (runs.status.values & FAILED).any()
    assert not access.failed(runs).any()
    assert usable(runs).notnull().all()
    # the report names the law and its range
    said = [text for text in cautions(runs) if "beyond the range" in text]
    assert len(said) == 1
    assert "1 of 3 runs" in said[0]
    assert "“kogut_etsion”" in said[0]
    assert "110 times" in said[0]
    assert not any("beyond" in text for text in cautions(runs.isel(run=[0, 2])))
    # the dataset states the range
    assert "kogut_etsion: indentation up to 110 times" in runs.contact.attrs["holds_for"]
    assert "outside_contact_law" in runs.status.attrs["flag_meanings"].split()


def test_the_terminal_says_so(capsys):
    print_responses(at(5.0))
    said = " ".join(capsys.readouterr().out.split())
    assert f"{WORDS[0].upper()}{WORDS[1:]}" in said
    assert "missing because" not in said
