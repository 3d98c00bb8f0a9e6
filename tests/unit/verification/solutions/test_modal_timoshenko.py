"""The Timoshenko beam's modal series: its convergence, its balances, and limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import slimmer, timoshenko_impact
from impactlab.verification.solutions import modal
from impactlab.verification.solutions.hertz import contact_stiffness
from impactlab.verification.solutions.modal import solve_timoshenko as solve
from impactlab.verification.solutions.shear import shear_stiffness

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()
STUBBY = replace(PAPER, beam=replace(PAPER.beam, span=0.2))
CASES = pytest.mark.parametrize(
    ("impact", "duration"),
    [(PAPER, 3e-4), (TIMOSHENKO, 2e-4), (STUBBY, 4e-4)],
    ids=["paper", "timoshenko", "stubby"],
)


def answers(solution):
    return np.array([solution.peak_force, solution.contact_duration])


@CASES
def test_default_step_and_modes_are_converged(impact, duration):
    fine = answers(solve(impact, duration, modes=400, step=duration / 20_000))
    np.testing.assert_allclose(answers(solve(impact, duration)), fine, rtol=3e-6)


@CASES
def test_error_falls_with_the_third_power_of_the_modes(impact, duration):
    """The modes left out follow the load but for F''/omega^2, and their sum goes with 1/modes."""
    fine = solve(impact, duration, modes=1600).midspan_deflection
    errors = [
        np.sqrt(np.mean((solve(impact, duration, modes=n).midspan_deflection - fine) ** 2))
        for n in (20, 160)
    ]
    assert errors[0] < 3e-6 * fine.max()
    order = np.log(errors[0] / errors[1]) / np.log(8)
    assert 2.3 < order < 3.7


@CASES
def test_second_order_in_the_step(impact, duration):
    coarse, middle, fine = (
        answers(solve(impact, duration, step=duration / n)) for n in (500, 1000, 2000)
    )
    order = np.log2((coarse - middle) / (middle - fine))
    np.testing.assert_allclose(order, 2.0, atol=0.1)


def test_modes_left_out_matter():
    one, many = (solve(PAPER, 3e-4, modes=n).peak_force for n in (1, 50))
    assert abs(one / many - 1) > 1e-3


def reference_motion(impact, count):
    """Right side of the same equations in W and Psi, not in modes; the rest of them static."""
    beam, k, a = impact.beam, contact_stiffness(impact), shear_stiffness(impact.beam)
    n = np.arange(1, 2 * count, 2)
    q, sign = n * np.pi / beam.span, (-1) ** (n // 2)
    mu, EI = beam.mass_per_length, beam.bending_stiffness
    inertia = mu * beam.depth**2 / 12
    static = 2 / beam.span * (1 / (EI * q**4) + 1 / (a * q**2)).sum()
    residual = beam.span**3 / (48 * EI) + beam.span / (4 * a) - static

    def force(gap):
        if gap <= 0:
            return 0.0
        delta = brentq(lambda d: d + residual * k * d**1.5 - gap, 0, gap, xtol=1e-20, rtol=1e-14)
        return k * delta**1.5

    def motion(_, state):
        place, speed = np.split(state, 2)
        W, Psi = np.split(place[1:], 2)
        push = force(place[0] - sign @ W)
        shear = a * (q * W - Psi)
        deflect = (2 / beam.span * push * sign - q * shear) / mu
        turn = (shear - EI * q**2 * Psi) / inertia
        sphere = impact.gravity - push / impact.sphere.total_mass
        return np.concatenate((speed, [sphere], deflect, turn))

    return motion, sign


@CASES
def test_agrees_with_a_general_integrator(impact, duration):
    count = 3
    start = np.zeros(2 * (2 * count + 1))
    start[2 * count + 1] = impact.velocity
    solution = solve(impact, duration, modes=count, step=duration / 4000)
    motion, sign = reference_motion(impact, count)
    path = solve_ivp(
        motion,
        (0, duration),
        start,
        method="DOP853",
        rtol=1e-10,
        atol=1e-15,
        t_eval=solution.time[::400],
    )
    np.testing.assert_allclose(
        solution.sphere_displacement[::400], path.y[0], rtol=2e-6, atol=1e-15
    )
    lower, upper = solution.amplitudes[::400, :count], solution.amplitudes[::400, count:]
    W = path.y[1 : count + 1].T * sign
    np.testing.assert_allclose(lower + upper, W, rtol=0, atol=2e-6 * np.abs(W).max())


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


@CASES
def test_energy_is_conserved(impact, duration):
    energy = total_energy(impact, solve(impact, 5 * duration))
    start = 0.5 * impact.sphere.total_mass * impact.velocity**2
    np.testing.assert_allclose(energy, start, rtol=1e-5)


def test_moment_under_a_slow_load_is_that_of_statics():
    """A light and slow sphere on a short beam: psi_x = -F L/(4 EI), the load being static."""
    impact = replace(STUBBY, velocity=1e-9, gravity=0.0, beam=replace(STUBBY.beam, span=0.1))
    impact = replace(impact, beam=replace(impact.beam, depth=0.05))
    solution = solve(impact, 5e-3, modes=40, step=5e-6)
    beam, deepest = impact.beam, np.argmax(solution.contact_force)
    force = solution.contact_force[deepest]
    expected = -force * beam.span / (4 * beam.bending_stiffness)
    assert solution.midspan_curvature[deepest] == pytest.approx(expected, rel=0.02)


@CASES
def test_slender_limit_is_the_euler_bernoulli_beam(impact, duration):
    """To bending all of these are one beam; shear and rotary inertia go with (depth/span)^2."""
    bare = modal.solve(impact, duration, modes=100)
    step, scale = bare.time[1], bare.contact_force.max()
    gaps = []
    for times in (4, 8, 16):
        slim = slimmer(impact, times)
        same = modal.solve(slim, duration, modes=100, step=step)
        np.testing.assert_allclose(same.contact_force, bare.contact_force, atol=1e-9 * scale)
        gap = solve(slim, duration, modes=100, step=step).contact_force - bare.contact_force
        gaps.append(np.sqrt(np.mean(gap**2)) / scale)
    assert gaps[0] < 0.01
    np.testing.assert_allclose(np.log2(gaps[1] / gaps[2]), 2.0, atol=0.05)


def test_papers_case():
    """Shear and rotary inertia lower its peak force by 2.2 % and prolong its contact by 1.4 %."""
    bare, full = modal.solve(PAPER, 4e-4), solve(PAPER, 4e-4)
    np.testing.assert_allclose(answers(full), [13323.0, 0.22883e-3], rtol=1e-4)
    np.testing.assert_allclose(answers(full) / answers(bare) - 1, [-0.0216, 0.0144], atol=1e-4)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"duration": 0.0}, "duration"),
        ({"step": -1e-7}, "step"),
        ({"modes": 0}, "modes|count"),
        ({"impact": paper_impact(contact="stronge")}, "contact"),
    ],
)
def test_wrong_arguments_are_named(change, word):
    with pytest.raises(ValueError, match=word):
        solve(**({"impact": PAPER, "duration": 1e-4} | change))
