"""Whole impacts against closed forms: Hertz's on a large block, Timoshenko's beam in modes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import eval_legendre

from impactlab.fem3d.solver import quarter_mesh, solve, solve_on
from impactlab.model.impact import Beam, Impact, Material, Sphere, paper_impact
from impactlab.verification.solutions import hertz, modal

STEEL = Material(density=7800.0, youngs_modulus=210e9, poissons_ratio=0.3, yield_stress=200e9)
RADIUS, TOUCH, BLOCK = 0.04, 1.9e-3, 0.6


def finite_sphere(material, radius, touch):
    """c in m/N: a sphere's contact comes closer to its centre of mass by c F less than Hertz says.

    The sphere under Hertz's pressure on a cap of radius `touch`, in Legendre modes of a ball
    (A. I. Lur'e, Three-dimensional problems of the theory of elasticity, 1964), accelerated by the
    first of them; Hertz: its pole against the far half-space.
    """
    E, nu = material.youngs_modulus, material.poissons_ratio
    G, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    r = 0.5 * (nodes + 1) * touch
    cos = np.sqrt(1 - (r / radius) ** 2)
    measure = 0.5 * touch * weights * r / radius**2 / cos
    count = int(16 * radius / touch)
    sums, pole = [], 0.0
    for n in range(count):
        p = (n + 0.5) * np.sum(np.sqrt(1 - (r / touch) ** 2) * eval_legendre(n, cos) * measure)
        if n == 0:
            u = p * radius / (3 * lame + 2 * G)
        elif n == 1:
            u = p * radius * 1.2 / (6 * lame + 4 * G)
        else:
            radial = (n + 1) * (n * n - n - 2 - 2 * nu), n * (n - 1)
            shear = n * n + 2 * n - 1 + 2 * nu, n - 1
            A, B = np.linalg.solve([radial, shear], [p / (2 * G), 0.0])
            u = radius * (A * (n + 1) * (n - 2 + 4 * nu) + B * n)
        pole += u
        sums.append(pole)
    half_space = math.pi * touch * (1 - nu**2) / (2 * E)
    return (half_space - np.mean(sums[count // 2 :])) / (2 / 3 * math.pi * touch**2)


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


def expected(impact, correction):
    """Peak force and duration of m y'' = -F, y = (F/k)^(2/3) - correction F."""
    modulus, mass = hertz.effective_modulus(impact), impact.sphere.total_mass
    k = hertz.stiffness(modulus, RADIUS)
    forces = np.linspace(0.0, 1.5 * hertz.peak_force(mass, impact.velocity, modulus, RADIUS), 40001)
    ways = (forces / k) ** (2 / 3) - correction * forces

    def motion(_, state):
        return state[1], -np.interp(state[0], ways, forces) / mass

    def leaves(time, state):
        return state[0] if time > 0 else 1.0

    leaves.terminal, leaves.direction = True, -1
    longest = 2 * hertz.contact_duration(mass, impact.velocity, modulus, RADIUS)
    way = solve_ivp(
        motion, (0, longest), (0, impact.velocity), events=leaves, rtol=1e-8, max_step=longest / 999
    )
    return np.interp(way.y[0].max(), ways, forces), way.t[-1]


def test_the_expected_impact_without_correction_is_hertz():
    impact = hertz_impact()
    given = impact.sphere.total_mass, impact.velocity, hertz.effective_modulus(impact), RADIUS
    peak, duration = expected(impact, 0.0)
    assert peak == pytest.approx(hertz.peak_force(*given), rel=1e-4)
    assert duration == pytest.approx(hertz.contact_duration(*given), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("element_size", "tolerance"),
    [(0.5e-3, 0.015), pytest.param(0.25e-3, 0.01, marks=pytest.mark.long)],
)
def test_a_sphere_on_a_large_block_is_hertz(element_size, tolerance):
    impact = hertz_impact()
    peak, duration = expected(impact, finite_sphere(STEEL, RADIUS, TOUCH))
    mesh = quarter_mesh(impact, element_size=element_size, coarsest=BLOCK / 8)
    answer = solve_on(mesh, impact, duration=1.1 * duration, threads=2)
    assert float(answer["peak_force"]) == pytest.approx(peak, rel=tolerance)
    assert float(answer["contact_duration"]) == pytest.approx(duration, rel=tolerance)
    assert float(answer["contact_loss"][-1]) < 1e-4 * float(answer["kinetic_energy"][0])
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
    sphere = finite_sphere(impact.sphere.material, impact.sphere.radius, touch)
    compliance = -(sphere + below_the_axis(impact))
    modes = modal.solve_timoshenko(impact, duration, compliance=compliance)
    assert float(answer["peak_force"]) == pytest.approx(modes.peak_force, rel=0.015)
    assert float(answer["contact_duration"]) == pytest.approx(modes.contact_duration, rel=0.01)
    time = answer["time"].values
    deflection = modes.at("midspan_deflection", time)
    error = np.abs(answer["midspan_deflection"].values - deflection).max()
    assert error < 0.01 * deflection.max()
