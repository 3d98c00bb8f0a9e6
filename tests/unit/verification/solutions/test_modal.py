"""The modal series of both theories: convergence, balances, limits, and other solutions."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import slimmer, timoshenko_impact
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.hertz import contact_stiffness
from impactlab.verification.solutions.modal import solve, solve_timoshenko

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()
STUBBY = replace(PAPER, beam=replace(PAPER.beam, span=0.2))
SLENDER = replace(PAPER, beam=replace(PAPER.beam, depth=0.008, width=0.02))
"""A heavy sphere on a slender beam: several sub-impacts."""
BENT = {"paper": (PAPER, 3e-4), "timoshenko": (TIMOSHENKO, 2e-4)}
SHEARED = BENT | {"stubby": (STUBBY, 4e-4)}
CASES = pytest.mark.parametrize(("impact", "duration"), BENT.values(), ids=BENT)
SHEARED_CASES = pytest.mark.parametrize(("impact", "duration"), SHEARED.values(), ids=SHEARED)
BOTH = pytest.mark.parametrize(
    ("solve", "impact", "duration"),
    [(solve, *case) for case in BENT.values()]
    + [(solve_timoshenko, *case) for case in SHEARED.values()],
    ids=[f"bernoulli-{name}" for name in BENT] + [f"timoshenko-{name}" for name in SHEARED],
)
CONSERVED = {solve: 5e-6, solve_timoshenko: 1e-5}


def answers(solution):
    return np.array([solution.peak_force, solution.contact_duration])


@BOTH
def test_second_order_in_the_step(solve, impact, duration):
    coarse, middle, fine = (
        answers(solve(impact, duration, step=duration / n)) for n in (500, 1000, 2000)
    )
    order = np.log2((coarse - middle) / (middle - fine))
    np.testing.assert_allclose(order, 2.0, atol=0.1)


def total_energy(impact, solution):
    """Kinetic, elastic, contact and gravitational energy in J, shape (time,)."""
    mass, modes = impact.sphere.total_mass, solution.modes
    modal_mass = 1 / (modes.flexibilities * modes.frequencies**2)
    kinetic = 0.5 * mass * solution.sphere_velocity**2 + 0.5 * solution.rates**2 @ modal_mass
    elastic = 0.5 * solution.amplitudes**2 @ (1 / modes.flexibilities)
    static = 0.5 * modes.residual_flexibility * solution.contact_force**2
    contact = 0.4 * contact_stiffness(impact) * np.maximum(solution.indentation, 0) ** 2.5
    fallen = mass * impact.gravity * solution.sphere_displacement
    return kinetic + elastic + static + contact - fallen


@pytest.mark.parametrize(
    ("solve", "impact", "duration"),
    [
        *((solve, impact, 2e-3) for impact in (PAPER, TIMOSHENKO, SLENDER)),
        *((solve_timoshenko, impact, 5 * duration) for impact, duration in SHEARED.values()),
    ],
)
def test_energy_is_conserved(solve, impact, duration):
    energy = total_energy(impact, solve(impact, duration))
    start = 0.5 * impact.sphere.total_mass * impact.velocity**2
    np.testing.assert_allclose(energy, start, rtol=CONSERVED[solve])


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
    solution = solve(SLENDER, 5e-3)
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
    # history at other times
    solution, fine = solve(PAPER, 3e-4, step=1e-6), solve(PAPER, 3e-4, step=2.5e-7)
    times = np.array([3.33e-5, 1.111e-4])
    indentation = solution.at("indentation", times)
    np.testing.assert_allclose(indentation, fine.at("indentation", times), rtol=1e-4)
    # sphere loses the impulse of the force
    solution, mass = solve(PAPER, 3e-4), PAPER.sphere.total_mass
    impulse = trapezoid(solution.contact_force, solution.time)
    change = mass * (solution.sphere_velocity[-1] - 0.99) - mass * 9.81 * 3e-4
    assert -change == pytest.approx(impulse, rel=1e-9)


def deflection(solution, x, step):
    """Return w (m) of Euler and Bernoulli's beam at `x` (m): modes, and the others' static rest."""
    modes, beam = solution.modes, solution.modes.beam
    off = x - beam.span / 2
    shapes, near = np.cos(np.outer(modes.wave_numbers, off)), beam.span / 2 - np.abs(off)
    static = near * (3 * beam.span**2 - 4 * near**2) / (48 * beam.bending_stiffness)
    rest = static - modes.flexibilities @ shapes
    return solution.amplitudes[step] @ shapes + solution.contact_force[step] * rest


def test_midspan_curvature_is_the_second_derivative_of_the_deflection():
    # Few modes, so that those left out carry a good part of the curvature.
    solution, dx = solve(PAPER, 3e-4, modes=8), PAPER.beam.span / 4000
    step = np.argmax(solution.contact_force)
    middle = PAPER.beam.span / 2
    w = deflection(solution, middle + np.array([-dx, 0.0, dx]), step)
    expected = (w[0] - 2 * w[1] + w[2]) / dx**2
    assert expected < 0
    assert solution.midspan_curvature[step] == pytest.approx(expected, rel=1e-2)


def test_moment_under_a_slow_load_is_that_of_statics():
    """A light and slow sphere on a short beam: psi_x = -F L/(4 EI), the load being static."""
    impact = replace(STUBBY, velocity=1e-9, gravity=0.0, beam=replace(STUBBY.beam, span=0.1))
    impact = replace(impact, beam=replace(impact.beam, depth=0.05))
    solution = solve_timoshenko(impact, 5e-3, modes=40, step=5e-6)
    beam, deepest = impact.beam, np.argmax(solution.contact_force)
    force = solution.contact_force[deepest]
    expected = -force * beam.span / (4 * beam.bending_stiffness)
    assert solution.midspan_curvature[deepest] == pytest.approx(expected, rel=0.02)


@SHEARED_CASES
def test_slender_limit_is_the_euler_bernoulli_beam(impact, duration):
    """To bending all of these are one beam; shear and rotary inertia go with (depth/span)^2."""
    bare = solve(impact, duration, modes=100)
    step, scale = bare.time[1], bare.contact_force.max()
    gaps = []
    for times in (4, 8, 16):
        slim = slimmer(impact, times)
        same = solve(slim, duration, modes=100, step=step)
        np.testing.assert_allclose(same.contact_force, bare.contact_force, atol=1e-9 * scale)
        gap = (
            solve_timoshenko(slim, duration, modes=100, step=step).contact_force
            - bare.contact_force
        )
        gaps.append(np.sqrt(np.mean(gap**2)) / scale)
    assert gaps[0] < 0.01
    np.testing.assert_allclose(np.log2(gaps[1] / gaps[2]), 2.0, atol=0.05)


def test_papers_case():
    """Shear and rotary inertia lower its peak force by 2.2 % and prolong its contact by 1.4 %."""
    bare, full = solve(PAPER, 4e-4), solve_timoshenko(PAPER, 4e-4)
    np.testing.assert_allclose(answers(full), [13323.0, 0.22883e-3], rtol=1e-4)
    np.testing.assert_allclose(answers(full) / answers(bare) - 1, [-0.0216, 0.0144], atol=1e-4)


@pytest.mark.parametrize("solve", [solve, solve_timoshenko])
def test_what_is_outside_is_refused(solve):
    with pytest.raises(ValueError, match="contact"):
        solve(paper_impact(contact="stronge"), 1e-4)
    solution = solve(PAPER, 5e-5)
    for time in (6e-5, np.nan):
        with pytest.raises(ValueError, match="time:"):
            solution.at("indentation", [time])
