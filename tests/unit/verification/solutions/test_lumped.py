"""Sphere on a lumped mass: closed forms, balances, and the march of one mode."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz, modal
from impactlab.verification.solutions.beam_modes import BeamModes, odd_modes

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()
CASES = pytest.mark.parametrize(
    ("impact", "duration"), [(PAPER, 4e-4), (TIMOSHENKO, 3e-4)], ids=["paper", "timoshenko"]
)


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


def test_a_free_mass_is_hertz_with_the_reduced_mass():
    impact = replace(PAPER, gravity=0.0)
    mass, velocity, *rest = hertz.arguments(impact)
    reduced = 1 / (1 / mass + 1 / 5.0)
    expected = [f(reduced, velocity, *rest) for f in (hertz.peak_force, hertz.contact_duration)]
    solution = hertz.solve(impact, 4e-4, mass=5.0)
    np.testing.assert_allclose(answers(solution), expected, rtol=1e-10)
    pushed = solution.at("midspan_velocity", [4e-4])
    np.testing.assert_allclose(pushed, 2 * mass / (mass + 5.0) * velocity, rtol=1e-10)


@CASES
def test_agrees_with_the_march_of_one_mode(impact, duration):
    """The same model, as a beam with one mode that holds all of the static deflection."""
    beam, (mass, stiffness) = impact.beam, hertz.spring_mass(impact.beam)
    table = BeamModes(
        beam,
        np.array([np.pi / beam.span]),
        np.array([np.sqrt(stiffness / mass)]),
        np.array([beam.span**3 / (48 * beam.bending_stiffness)]),
        np.array([-12 / beam.span**2]),
        (beam.span**3 / (48 * beam.bending_stiffness), -beam.span / (4 * beam.bending_stiffness)),
    )
    marched = modal.solve_with(table, impact, duration, duration / 10_000)
    solution = hertz.solve_spring_mass(impact, duration)
    np.testing.assert_allclose(answers(solution), answers(marched), rtol=3e-7)
    times = marched.time[::100]
    for name in ("contact_force", "midspan_deflection", "sphere_velocity", "indentation"):
        ours, theirs = solution.at(name, times), marched.at(name, times)
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-6 * np.abs(theirs).max())


def test_contact_that_outlasts_the_duration_has_no_end():
    solution = hertz.solve_spring_mass(PAPER, 5e-5)
    assert np.isnan(solution.contact_duration)
    np.testing.assert_allclose(solution.at("contact_force", [5e-5]), solution.peak_force)


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
