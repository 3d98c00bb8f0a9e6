"""The modal series of both theories: convergence, balances, limits, and other solutions."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions.beam_modes import odd_modes
from impactlab.verification.solutions.hertz import contact_stiffness
from impactlab.verification.solutions.modal import solve, solve_timoshenko, solve_with

PAPER, TIMOSHENKO = paper_impact(contact="hertz"), timoshenko_impact()
STUBBY = replace(PAPER, beam=replace(PAPER.beam, span=0.2))
SLENDER = replace(PAPER, beam=replace(PAPER.beam, depth=0.008, width=0.02))
"""A heavy sphere on a slender beam: several sub-impacts."""
BENT = {"paper": (PAPER, 3e-4), "timoshenko": (TIMOSHENKO, 2e-4)}
SHEARED = BENT | {"stubby": (STUBBY, 4e-4)}
CASES = pytest.mark.parametrize(("impact", "duration"), BENT.values(), ids=BENT)


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


def integrated(motion, duration, start, times, **options):
    """States at the times, (states, times), by a general integrator."""
    tight = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-15, **options}
    return solve_ivp(motion, (0, duration), start, t_eval=times, **tight).y


def reference_motion(impact, count, residual):
    """Right side of the same equations, modes written out by hand; the rest of them static."""
    beam, k = impact.beam, contact_stiffness(impact)
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
    compliance = share * peak ** (-1 / 3) * contact_stiffness(impact) ** (-2 / 3)
    count, beam = 4, impact.beam
    tail = sum(1 / n**4 for n in range(2 * count + 1, 20_001, 2))
    rest = 2 * beam.span**3 / (np.pi**4 * beam.bending_stiffness) * tail
    start = np.zeros(2 * count + 2)
    start[count + 1] = impact.velocity
    modes, step = odd_modes(beam, count), duration / 4000
    solution = solve_with(modes, impact, duration, step, compliance)
    times = solution.time[::400]
    motion = reference_motion(impact, count, rest + compliance)
    path = integrated(motion, duration, start, times, max_step=duration / 100)
    sphere, beam_deflection = path[0], path[1 : count + 1]
    np.testing.assert_allclose(solution.sphere_displacement[::400], sphere, rtol=1e-6, atol=1e-15)
    scale = np.abs(beam_deflection).max()
    np.testing.assert_allclose(
        solution.amplitudes[::400], beam_deflection.T, rtol=0, atol=1e-6 * scale
    )
    whole = beam_deflection.sum(0) + rest * solution.contact_force[::400]
    np.testing.assert_allclose(solution.midspan_deflection[::400], whole, rtol=0, atol=1e-6 * scale)


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
