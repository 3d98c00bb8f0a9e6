"""The modal series: its own convergence, and checks against other solutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp, trapezoid
from scipy.optimize import brentq

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import odd_modes
from impactlab.verification.solutions.modal import solve, solve_with

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()
CASES = pytest.mark.parametrize(
    ("impact", "duration"), [(PAPER, 3e-4), (TIMOSHENKO, 2e-4)], ids=["paper", "timoshenko"]
)


def answers(solution):
    return np.array([solution.peak_force, solution.contact_duration])


def stiffness(impact):
    return hertz.stiffness(hertz.effective_modulus(impact), hertz.effective_radius(impact))


def slender():
    """A heavy sphere on a slender beam: several sub-impacts."""
    return replace(PAPER, beam=replace(PAPER.beam, depth=0.008, width=0.02))


@CASES
def test_default_step_and_modes_are_converged(impact, duration):
    fine = answers(solve(impact, duration, modes=200, step=duration / 20_000))
    np.testing.assert_allclose(answers(solve(impact, duration)), fine, rtol=1e-6)


@CASES
def test_second_order_in_the_step(impact, duration):
    coarse, middle, fine = (
        answers(solve(impact, duration, step=duration / n)) for n in (300, 600, 1200)
    )
    order = np.log2((coarse - middle) / (middle - fine))
    np.testing.assert_allclose(order, 2.0, atol=0.1)


@CASES
def test_few_modes_are_enough(impact, duration):
    few, many = (answers(solve(impact, duration, modes=n)) for n in (10, 80))
    np.testing.assert_allclose(few, many, rtol=1e-5)


def test_modes_left_out_matter():
    """One mode with its static rest is far from converged: the two tests above can fail."""
    one, many = (solve(PAPER, 3e-4, modes=n).peak_force for n in (1, 50))
    assert abs(one / many - 1) > 1e-3


def reference_motion(impact, count, residual):
    """Right side of the same equations, modes written out by hand; the rest of them static."""
    beam, k = impact.beam, stiffness(impact)
    orders = np.arange(1, 2 * count, 2)
    squares = (orders * np.pi / beam.span) ** 4 * beam.bending_stiffness / beam.mass_per_length
    modal_mass = beam.mass_per_length * beam.span / 2

    def force(gap):
        if gap <= 0:
            return 0.0
        ends = 0, 2 * gap
        delta = brentq(lambda d: d + residual * k * d**1.5 - gap, *ends, xtol=1e-20, rtol=1e-14)
        return k * delta**1.5

    def motion(_, state):
        place, speed = state[: count + 1], state[count + 1 :]
        push = force(place[0] - place[1:].sum())
        sphere = impact.gravity - push / impact.sphere.total_mass
        return np.concatenate((speed, [sphere], push / modal_mass - squares * place[1:]))

    return motion


@CASES
@pytest.mark.parametrize("share", [0.0, 0.1, -0.1])
def test_agrees_with_a_general_integrator(impact, duration, share):
    """share: compliance beyond Hertz's, over what his law has at the peak."""
    peak = solve(impact, duration).peak_force
    compliance = share * peak ** (-1 / 3) * stiffness(impact) ** (-2 / 3)
    count, beam = 4, impact.beam
    tail = sum(1 / n**4 for n in range(2 * count + 1, 20_001, 2))
    rest = 2 * beam.span**3 / (np.pi**4 * beam.bending_stiffness) * tail
    start = np.zeros(2 * count + 2)
    start[count + 1] = impact.velocity
    modes, step = odd_modes(beam, count), duration / 4000
    solution = solve_with(modes, impact, duration, step, compliance)
    times = solution.time[::400]
    motion = reference_motion(impact, count, rest + compliance)
    path = solve_ivp(
        motion,
        (0, duration),
        start,
        method="DOP853",
        rtol=1e-10,
        atol=1e-15,
        max_step=duration / 100,
        t_eval=times,
    )
    sphere, beam_deflection = path.y[0], path.y[1 : count + 1]
    np.testing.assert_allclose(solution.sphere_displacement[::400], sphere, rtol=1e-6, atol=1e-15)
    scale = np.abs(beam_deflection).max()
    np.testing.assert_allclose(
        solution.amplitudes[::400], beam_deflection.T, rtol=0, atol=1e-6 * scale
    )
    whole = beam_deflection.sum(0) + rest * solution.contact_force[::400]
    np.testing.assert_allclose(solution.midspan_deflection[::400], whole, rtol=0, atol=1e-6 * scale)


def total_energy(impact, solution):
    """Kinetic, bending, contact and gravitational energy in J, shape (time,)."""
    mass, modes = impact.sphere.total_mass, solution.modes
    modal_mass = impact.beam.mass_per_length * impact.beam.span / 2
    kinetic = 0.5 * mass * solution.sphere_velocity**2 + 0.5 * modal_mass * np.sum(
        solution.rates**2, 1
    )
    bending = 0.5 * modal_mass * np.sum((modes.frequencies * solution.amplitudes) ** 2, 1)
    static = 0.5 * modes.residual_flexibility * solution.contact_force**2
    contact = 0.4 * stiffness(impact) * np.maximum(solution.indentation, 0) ** 2.5
    fallen = mass * impact.gravity * solution.sphere_displacement
    return kinetic + bending + static + contact - fallen


@pytest.mark.parametrize(
    "impact", [PAPER, TIMOSHENKO, slender()], ids=["paper", "timoshenko", "slender"]
)
def test_energy_is_conserved(impact):
    energy = total_energy(impact, solve(impact, 2e-3))
    start = 0.5 * impact.sphere.total_mass * impact.velocity**2
    np.testing.assert_allclose(energy, start, rtol=5e-6)


def test_sphere_loses_the_impulse_of_the_force():
    solution, mass = solve(PAPER, 3e-4), PAPER.sphere.total_mass
    impulse = trapezoid(solution.contact_force, solution.time)
    change = mass * (solution.sphere_velocity[-1] - 0.99) - mass * 9.81 * 3e-4
    assert -change == pytest.approx(impulse, rel=1e-9)


def test_wide_beam_is_a_half_space():
    wide = replace(PAPER, beam=replace(PAPER.beam, width=1e6), gravity=0.0)
    mass, radius = wide.sphere.total_mass, wide.sphere.radius
    arguments = (mass, wide.velocity, hertz.effective_modulus(wide), radius)
    expected = [hertz.peak_force(*arguments), hertz.contact_duration(*arguments)]
    solution = solve(wide, 3e-4)
    np.testing.assert_allclose(answers(solution), expected, rtol=2e-6)
    assert solution.time_of_peak_force == pytest.approx(expected[1] / 2, rel=2e-6)
    assert solution.sphere_velocity[-1] == pytest.approx(-wide.velocity, rel=2e-6)


def test_contacts_are_where_the_force_is():
    solution = solve(slender(), 5e-3)
    assert len(solution.contacts) >= 2
    assert solution.contacts[0, 0] == 0.0
    assert np.all(np.diff(solution.contacts.ravel()[:-1]) > 0)
    ends = np.nan_to_num(solution.contacts, nan=np.inf)
    inside = np.any((ends[:, :1] < solution.time) & (solution.time < ends[:, 1:]), axis=0)
    np.testing.assert_array_equal(inside, solution.contact_force > 0)
    assert solution.contact_duration == solution.contacts[0, 1]


def test_contact_that_outlasts_the_duration_has_no_end():
    solution = solve(PAPER, 1.5e-4)
    assert np.isnan(solution.contact_duration)
    assert solution.peak_force == pytest.approx(solve(PAPER, 3e-4).peak_force, rel=1e-6)


def test_peak_force_is_above_every_step_and_close_to_the_highest():
    solution = solve(PAPER, 3e-4, step=1e-5)
    assert solution.peak_force > solution.contact_force.max()
    fine = solve(PAPER, 3e-4)
    assert fine.peak_force == pytest.approx(fine.contact_force.max(), rel=5e-6)
    nearest = fine.time[np.argmax(fine.contact_force)]
    assert fine.time_of_peak_force == pytest.approx(nearest, abs=fine.time[1])


def test_deflection_along_the_beam():
    solution = solve(PAPER, 1e-3, modes=20)
    steps, span = [200, 1500, 4000], PAPER.beam.span
    w = solution.deflection([0, 0.2, span / 2, span - 0.2, span], solution.time[steps])
    assert w.shape == (3, 5)
    np.testing.assert_allclose(w[:, 2], solution.midspan_deflection[steps], rtol=1e-9)
    np.testing.assert_allclose(w[:, 1], w[:, 3], rtol=1e-9)
    np.testing.assert_allclose(w[:, [0, 4]], 0, atol=1e-12 * np.abs(w).max())


def test_midspan_curvature_is_the_second_derivative_of_the_deflection():
    # Few modes, so that those left out carry a good part of the curvature.
    solution, dx = solve(PAPER, 3e-4, modes=8), PAPER.beam.span / 4000
    step = np.argmax(solution.contact_force)
    middle = PAPER.beam.span / 2
    w = solution.deflection([middle - dx, middle, middle + dx], solution.time[step])[0]
    expected = (w[0] - 2 * w[1] + w[2]) / dx**2
    assert expected < 0
    assert solution.midspan_curvature[step] == pytest.approx(expected, rel=1e-2)


def test_history_at_other_times():
    solution, fine = solve(PAPER, 3e-4, step=1e-6), solve(PAPER, 3e-4, step=2.5e-7)
    times = np.array([3.33e-5, 1.111e-4])
    indentation = solution.at("indentation", times)
    np.testing.assert_allclose(indentation, fine.at("indentation", times), rtol=1e-4)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"duration": 0.0}, "duration"),
        ({"duration": np.nan}, "duration"),
        ({"step": -1e-7}, "step"),
        ({"modes": 0}, "modes"),
        ({"impact": paper_impact(contact="stronge")}, "contact"),
    ],
)
def test_wrong_arguments_are_named(change, word):
    with pytest.raises(ValueError, match=word):
        solve(**({"impact": PAPER, "duration": 1e-4} | change))


def test_places_and_times_outside_are_refused():
    solution = solve(PAPER, 5e-5)
    with pytest.raises(ValueError, match="x:"):
        solution.deflection([0.8], [0.0])
    with pytest.raises(ValueError, match="time:"):
        solution.deflection([0.4], [6e-5])
    with pytest.raises(ValueError, match="time:"):
        solution.at("indentation", [np.nan])
