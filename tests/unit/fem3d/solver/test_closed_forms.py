"""Whole impacts against closed forms: Hertz's on a large block, Timoshenko's beam in modes."""

import math
from dataclasses import replace

import numpy as np
import pytest
import whole_sphere

from impactlab.fem3d.solver import impact_mesh, solve, solve_on
from impactlab.model.bodies import Beam, Sphere
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.material import Material
from impactlab.verification.solutions import beam_modes, hertz, modal

STEEL = Material(density=7800.0, youngs_modulus=210e9, poissons_ratio=0.3, yield_stress=200e9)
RADIUS, TOUCH, BLOCK = 0.04, 1.9e-3, 0.6


def hertz_impact():
    """Radius of contact at most TOUCH, in an elastic block that hardly gives way as a whole."""
    mass, modulus = 7800 * 4 / 3 * math.pi * RADIUS**3, 210e9 / 0.91 / 2
    velocity = math.sqrt(16 * modulus * math.sqrt(RADIUS) * (TOUCH**2 / RADIUS) ** 2.5 / 15 / mass)
    return Impact(
        sphere=Sphere(radius=RADIUS, material=STEEL),
        beam=Beam(span=2 * BLOCK * 1.001, width=2 * BLOCK, depth=BLOCK, material=STEEL),
        velocity=velocity,
        gravity=0.0,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("element_size", "ratio"), [(0.7e-3, 1.6), pytest.param(0.35e-3, 1.3, marks=pytest.mark.long)]
)
def test_a_sphere_on_a_large_block_is_hertz(element_size, ratio):
    impact = hertz_impact()
    peak, duration = whole_sphere.impact(impact)
    assert peak == pytest.approx(hertz.peak_force(*hertz.arguments(impact)), rel=0.02)
    mesh = impact_mesh(impact, element_size=element_size, ratio=ratio, coarsest=BLOCK / 8)
    answer = solve_on(mesh, impact, duration=1.1 * duration, threads=2)
    assert float(answer["peak_force"]) == pytest.approx(peak, rel=0.01)
    assert float(answer["contact_duration"]) == pytest.approx(duration, rel=0.01)
    # kept and lost where faces touch in part, which falls with the square of the element size
    bound = 6e-4 * (element_size / 0.7e-3) ** 2
    assert float(answer["contact_work"][-1]) < bound * float(answer["kinetic_energy"][0])
    assert float(answer["energy_error"]) < 1e-4
    assert float(answer["peak_plastic_strain"]) == 0.0


def below_the_axis(impact):
    """Compliance in m/N of a half-space below the depth of the beam's axis, which is not there.

    J. Boussinesq, Application des potentiels (1885): w = (1 + nu)(3 - 2 nu) F/(2 pi E z).
    """
    steel, depth = impact.beam.material, 0.5 * impact.beam.depth
    nu = steel.poissons_ratio
    return (1 + nu) * (3 - 2 * nu) / (2 * math.pi * steel.youngs_modulus * depth)


@pytest.mark.long
def test_the_elastic_beam_answers_as_timoshenkos_modes():
    """The paper's beam without yield, under Hertz's law for bodies that end.

    Without that the modes' force is 4 % too small: the approach is that of the sphere's centre and
    the beam's axis, and neither body goes on beyond. Their shape beside the contact is left out.
    """
    paper = paper_impact(contact="hertz")
    impact = replace(paper, beam=replace(paper.beam, material=STEEL))
    duration = 0.3e-3
    answer = solve(impact, element_size=0.5e-3, duration=duration, threads=2)
    touch = math.sqrt(impact.sphere.radius * 40e-6)
    ball = impact.sphere.material
    sphere = whole_sphere.extra_compliance(
        impact.sphere.radius, touch, ball.youngs_modulus, ball.poissons_ratio
    )
    compliance = sphere - below_the_axis(impact)
    sheared = beam_modes.timoshenko_odd_modes(impact.beam, 100)
    modes = modal.solve_with(sheared, impact, duration, None, compliance)
    assert float(answer["peak_force"]) == pytest.approx(modes.peak_force, rel=0.015)
    assert float(answer["contact_duration"]) == pytest.approx(modes.contact_duration, rel=0.01)
    time = answer["time"].values
    deflection = modes.at("midspan_deflection", time)
    error = np.abs(answer["midspan_deflection"].values - deflection).max()
    assert error < 0.01 * deflection.max()
