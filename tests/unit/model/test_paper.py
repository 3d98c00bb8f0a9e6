"""The paper's case against its Tables 2 and 3."""

import pytest

import impactlab as il

IMPACT = il.paper_impact()


def test_sphere_of_gr_15():
    sphere, steel = IMPACT.sphere, IMPACT.sphere.material
    assert sphere.radius == 35e-3
    assert steel.density == 7800
    assert steel.youngs_modulus == 208e9
    assert steel.poissons_ratio == 0.3
    assert steel.yield_stress == 2550e6
    assert round(sphere.total_mass, 1) == 1.4  # the printed mass agrees with density x volume


def test_beam_of_q345():
    beam, steel = IMPACT.beam, IMPACT.beam.material
    assert (beam.depth, beam.width, beam.span) == (27.8e-3, 60e-3, 780e-3)
    assert steel.density == 7800
    assert steel.youngs_modulus == 210e9
    assert steel.poissons_ratio == 0.3
    assert steel.yield_stress == 345e6
    assert steel.isotropic_hardening_modulus == 0  # elastic-perfectly plastic
    assert steel.kinematic_hardening_modulus == 0
    # beam weighs what its volume does and not the printed mass
    mass = IMPACT.beam.mass_per_length * IMPACT.beam.span
    assert mass == pytest.approx(10.148, abs=5e-4)
    assert IMPACT.beam.mass_per_length * 0.84 == pytest.approx(10.929, abs=5e-4)
    # bending stiffness is that of the rectangle
    assert IMPACT.beam.bending_stiffness == pytest.approx(210e9 * 0.06 * 0.0278**3 / 12, rel=1e-14)


def test_impact_at_0_99_m_per_s_under_stronge_with_gravity():
    assert (IMPACT.velocity, IMPACT.contact, IMPACT.gravity) == (0.99, "stronge", 9.81)
    assert il.paper_impact(20.0, "hertz").velocity == 20.0
    assert il.paper_impact(20.0, "hertz").contact == "hertz"
    # a stated mass goes before density
    sphere = il.Sphere(radius=0.035, material=IMPACT.sphere.material, mass=10.0)
    assert sphere.total_mass == 10.0
