"""The mode solution against its equation of motion, and against the balance of energy."""

from __future__ import annotations

from dataclasses import replace

import pytest
from scipy.integrate import quad

from impactlab.model.paper import paper_impact
from impactlab.verification.solutions import bending, rigid_plastic, static_loading

BASE = paper_impact(2.0)
IMPACT = replace(BASE, sphere=replace(BASE.sphere, mass=200.0))


def test_mode_mass_is_that_of_the_triangle():
    """Integral of mu (x/(L/2))^2 over the beam, and the striker."""
    beam = IMPACT.beam
    half, _ = quad(lambda x: beam.mass_per_length * (2 * x / beam.span) ** 2, 0, beam.span / 2)
    assert rigid_plastic.mode_mass(IMPACT) == pytest.approx(200 + 2 * half, rel=1e-12)


def test_mode_leaves_the_least_kinetic_energy_of_the_difference():
    beam, v = IMPACT.beam, rigid_plastic.mode_velocity(IMPACT)

    def difference(velocity):
        triangle = beam.mass_per_length * beam.span / 3 * velocity**2
        return 0.5 * (200 * (2.0 - velocity) ** 2 + triangle)

    assert difference(v) < min(difference(v * 1.001), difference(v * 0.999))


def test_a_constant_force_brakes_it():
    w, v, t = (
        getattr(rigid_plastic, name)(IMPACT)
        for name in ("final_deflection", "mode_velocity", "duration")
    )
    assert w == pytest.approx(0.5 * v * t, rel=1e-12)
    work = 4 * 345e6 * 0.06 * 0.0278**2 / 4 / 0.78 * w
    assert rigid_plastic.mode_energy(IMPACT) == pytest.approx(work, rel=1e-12)


def test_energy_ratio_by_hand():
    load = bending.collapse_load(IMPACT.beam)
    stored = load**2 * 0.78**3 / (96 * 210e9 * 0.06 * 0.0278**3 / 12)
    assert rigid_plastic.energy_ratio(IMPACT) == pytest.approx(400 / stored, rel=1e-12)


def test_elastic_plastic_deflection_balances_energy():
    """The static curve's work up to the largest deflection is the mode's energy."""
    heavy = replace(IMPACT, velocity=4.0)
    beam, load = heavy.beam, bending.collapse_load(heavy.beam)
    largest = rigid_plastic.elastic_plastic_deflection(heavy) + bending.static_deflection(
        beam, load
    )
    work, _ = quad(lambda w: static_loading.load_at(beam, w), 1e-9, largest, limit=200)
    assert work == pytest.approx(rigid_plastic.mode_energy(heavy), rel=1e-5)
