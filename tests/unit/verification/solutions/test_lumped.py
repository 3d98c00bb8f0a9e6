"""Sphere on a lumped mass: closed forms, balances, and the march of one mode."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import odd_modes

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()


def answers(solution):
    return np.array([solution.peak_force, solution.contact_duration])


def test_mass_and_stiffness_by_quadrature_of_the_static_shape():
    beam, L = PAPER.beam, PAPER.beam.span

    def shape(x):
        return (3 * x * L**2 - 4 * x**3) / L**3

    energy, _ = quad(lambda x: 2 * shape(x) ** 2, 0, L / 2)
    bending, _ = quad(lambda x: 2 * (24 * x / L**3) ** 2, 0, L / 2)
    mass, stiffness = hertz.spring_mass(beam)
    assert mass == pytest.approx(beam.mass_per_length * energy, rel=1e-12)
    assert stiffness == pytest.approx(beam.bending_stiffness * bending, rel=1e-12)
    # Above the first of the modes, and close to it.
    mass, stiffness = hertz.spring_mass(PAPER.beam)
    ratio = np.sqrt(stiffness / mass) / odd_modes(PAPER.beam, 1).frequencies[0]
    assert ratio == pytest.approx(1.0072, abs=1e-4)


@pytest.mark.parametrize("impact", [PAPER, TIMOSHENKO], ids=["paper", "timoshenko"])
def test_rigid_beam_without_gravity_is_hertz(impact):
    impact = replace(impact, gravity=0.0)
    arguments = hertz.arguments(impact)
    peak, duration = hertz.peak_force(*arguments), hertz.contact_duration(*arguments)
    solution = hertz.solve(impact, 1.5 * duration)
    np.testing.assert_allclose(answers(solution), [peak, duration], rtol=1e-10)
    assert solution.time_of_peak_force == pytest.approx(duration / 2, rel=1e-9)
    left = solution.at("sphere_velocity", [1.2 * duration])
    np.testing.assert_allclose(left, -impact.velocity, rtol=1e-10)
    np.testing.assert_array_equal(solution.at("midspan_deflection", [duration]), 0.0)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: hertz.solve(paper_impact(contact="stronge"), 1e-4), "contact"),
        (lambda: hertz.solve_spring_mass(PAPER, 1e-5).at("contact_force", [2e-5]), "time:"),
    ],
)
def test_wrong_arguments_are_named(call, word):
    with pytest.raises(ValueError, match=word):
        call()
