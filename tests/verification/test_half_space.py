"""A beam too heavy to move: the contact laws alone, against their closed forms."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.reference import hertz
from impactlab.reference.stronge import stronge_impact


def rigid_backed(velocity, contact):
    """The paper's sphere on a beam of enormous mass (E* as it is), without gravity."""
    impact = il.paper_impact(velocity, contact)
    heavy = replace(impact.beam.material, density=7.8e9)
    return replace(impact, beam=replace(impact.beam, material=heavy), gravity=0.0)


def solve(impact, duration):
    # a small Courant number: here the contact alone sets the time step
    grid = il.Discretisation(nodes=11, points=3, courant=0.005)
    return il.simulate(impact, grid, duration=duration)


def test_hertz_impact_on_a_half_space():
    impact = rigid_backed(0.99, "hertz")
    args = (
        impact.sphere.total_mass,
        0.99,
        hertz.effective_modulus(impact),
        hertz.effective_radius(impact),
    )
    run = solve(impact, 0.4e-3)
    assert run.peak_force.item() == pytest.approx(hertz.peak_force(*args), rel=1e-4)
    assert run.contact_duration.item() == pytest.approx(hertz.contact_duration(*args), rel=1e-4)
    assert run.maximum_indentation.item() == pytest.approx(
        hertz.maximum_indentation(*args), rel=1e-4
    )
    assert run.restitution.item() == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("velocity", [0.005, 0.05, 0.3, 0.99, 3.0, 10.0, 20.0])
def test_restitution_and_dent_of_the_stronge_law(velocity):
    impact = rigid_backed(velocity, "stronge")
    law, mass = stronge_impact(impact), impact.sphere.total_mass
    run = solve(impact, 0.3e-3 * (0.99 / velocity) ** 0.2 + 0.1e-3)
    deepest = law.maximum_indentation(velocity, mass)
    assert run.maximum_indentation.item() == pytest.approx(deepest, rel=2e-4)
    assert run.peak_force.item() == pytest.approx(law.peak_force(velocity, mass), rel=2e-4)
    assert run.restitution.item() == pytest.approx(law.restitution(velocity, mass), abs=2e-4)
    # measured by the deepest indentation: below it the law's residual passes through zero
    dent = run.permanent_indentation.item() - law.residual_indentation(deepest)
    assert abs(dent) < 2e-4 * deepest


@pytest.mark.parametrize("velocity", [0.02, 0.99, 10.0])
def test_contact_dissipation_is_the_kinetic_energy_lost(velocity):
    run = solve(rigid_backed(velocity, "stronge"), 0.6e-3)
    before = 0.5 * run.sphere_mass.item() * velocity**2
    lost = 1 - run.restitution.item() ** 2
    assert run.contact_dissipation.item() / before == pytest.approx(lost, abs=3e-4)


def test_stronge_law_creates_energy_just_above_yield():
    """physics.md; the dataset must show it, not hide it."""
    impact = rigid_backed(1.0, "stronge")
    law = stronge_impact(impact)
    work = law.loading_work(1.4 * law.yield_indentation)
    slow = float(np.sqrt(2 * work / impact.sphere.total_mass))
    run = solve(replace(impact, velocity=slow), 1e-3)
    assert run.restitution.item() > 1.05
    assert run.contact_dissipation.item() < 0
