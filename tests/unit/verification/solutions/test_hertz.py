"""Hertz's closed forms against the equation of motion integrated in time."""

import math

import pytest
from scipy.integrate import solve_ivp

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz

MASS, VELOCITY, MODULUS, RADIUS = 1.4, 2.0, 1.15e11, 0.035


def rebound():
    """Indentation and velocity until the sphere leaves, from m d'' = -(4/3) E sqrt(R) d^1.5."""

    def motion(_, state):
        depth = max(state[0], 0.0)
        return state[1], -4 / 3 * MODULUS * math.sqrt(RADIUS) * depth**1.5 / MASS

    def leaves(_, state):
        return state[0]

    def stops(_, state):
        return state[1]

    leaves.terminal, leaves.direction = True, -1
    return solve_ivp(
        motion,
        (0, 1e-2),
        (0.0, VELOCITY),
        method="DOP853",
        rtol=1e-10,
        atol=1e-16,
        events=(leaves, stops),
        max_step=5e-6,
    )


def test_closed_forms_solve_the_equation_of_motion():
    path = rebound()
    deepest = path.y_events[1][0][0]
    arguments = (MASS, VELOCITY, MODULUS, RADIUS)
    assert hertz.maximum_indentation(*arguments) == pytest.approx(deepest, rel=1e-7)
    assert hertz.contact_duration(*arguments) == pytest.approx(path.t_events[0][0], rel=1e-7)
    force = 4 / 3 * MODULUS * math.sqrt(RADIUS) * deepest**1.5
    assert hertz.peak_force(*arguments) == pytest.approx(force, rel=1e-7)
    assert pytest.approx(2.9433, abs=5e-5) == hertz.CONTACT_TIME_FACTOR


def test_effective_modulus_of_like_bodies_is_half_the_plane_strain_one():
    steel = timoshenko_impact().beam.material
    expected = steel.youngs_modulus / (2 * (1 - 0.3**2))
    assert hertz.effective_modulus(timoshenko_impact()) == pytest.approx(expected, rel=1e-12)
    assert hertz.effective_modulus(paper_impact()) == pytest.approx(
        208e9 * 210e9 / (418e9 * 0.91), rel=1e-12
    )
