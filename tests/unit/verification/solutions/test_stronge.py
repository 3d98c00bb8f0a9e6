"""The Stronge law's closed forms against integrals of the force, over depth and over time."""

import math
from itertools import pairwise

import pytest
from scipy.integrate import quad, solve_ivp

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions.contact_laws import StrongeImpact, stronge_impact

BODIES = StrongeImpact(115e9, 0.035, 345e6)
MASS = 1.4
DEPTHS = [0.6, 1.0, 1.5, 10.0, 82.0, 83.0, 400.0]


def written_out(x):
    """F/F_y as printed, with misprints put right."""
    u = 2 * x - 1
    if x <= 1:
        return x**1.5
    if x <= 82.511:
        return u * (1 + math.log(u) / 3.3)
    return 2.8 * u / 1.1


def velocity_reaching(x):
    return math.sqrt(2 * BODIES.loading_work(x * BODIES.yield_indentation) / MASS)


@pytest.mark.parametrize("x", DEPTHS)
def test_loading_force_is_the_law_written_out(x):
    force = BODIES.loading_force(x * BODIES.yield_indentation)
    assert force == pytest.approx(BODIES.yield_force * written_out(x), rel=1e-12)


@pytest.mark.parametrize("x", DEPTHS)
def test_loading_work_is_the_integral_of_the_force(x):
    limits = [0.0, *(limit for limit in (1.0, 82.511) if limit < x), x]
    work = sum(quad(written_out, a, b, epsabs=0, epsrel=1e-12)[0] for a, b in pairwise(limits))
    expected = work * BODIES.yield_force * BODIES.yield_indentation
    assert BODIES.loading_work(x * BODIES.yield_indentation) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("x", [1.5, 10.0, 400.0])
def test_released_work_is_the_integral_of_the_unloading_force(x):
    deepest = x * BODIES.yield_indentation
    start = BODIES.residual_indentation(deepest)
    work = quad(BODIES.unloading_force, start, deepest, args=(deepest,), epsabs=0, epsrel=1e-10)[0]
    assert BODIES.released_work(deepest) == pytest.approx(work, rel=1e-8)


@pytest.mark.parametrize("x", [0.6, 1.5, 10.0, 400.0])
def test_unloading_starts_at_the_force_reached(x):
    deepest = x * BODIES.yield_indentation
    force = BODIES.unloading_force(deepest, deepest)
    assert force == pytest.approx(BODIES.loading_force(deepest), rel=1e-12)


@pytest.mark.parametrize("x", DEPTHS)
def test_maximum_indentation_inverts_the_work(x):
    deepest = BODIES.maximum_indentation(velocity_reaching(x), MASS)
    assert deepest == pytest.approx(x * BODIES.yield_indentation, rel=1e-12)


@pytest.mark.parametrize("x", [1.5, 10.0, 200.0])
def test_restitution_is_the_rebound_of_the_sphere(x):
    velocity = velocity_reaching(x)
    deepest = BODIES.maximum_indentation(velocity, MASS)
    residual = BODIES.residual_indentation(deepest)

    def motion(_, state):
        return state[1], -BODIES.unloading_force(state[0], deepest) / MASS

    def leaves(_, state):
        return state[0] - residual - 1e-9 * deepest

    leaves.terminal = True
    path = solve_ivp(
        motion, (0, 1.0), (deepest, 0.0), events=leaves, rtol=1e-9, atol=1e-15, max_step=1e-3
    )
    assert path.status == 1
    assert BODIES.restitution(velocity, MASS) == pytest.approx(-path.y[1, -1] / velocity, rel=1e-6)


def test_restitution_is_one_up_to_yield():
    work = 0.4 * BODIES.yield_force * BODIES.yield_indentation
    limit = math.sqrt(2.0 * work / MASS)
    assert BODIES.restitution(0.5 * limit, MASS) == pytest.approx(1.0, abs=1e-14)
    assert BODIES.restitution(limit * (1 + 1e-9), MASS) == pytest.approx(1.0, abs=1e-6)
    assert BODIES.residual_indentation(0.9 * BODIES.yield_indentation) == 0.0


def integrated_restitution(x):
    """From the two works alone, both by quadrature in units of F_y delta_y."""
    put_in = quad(written_out, 0, x, points=[1.0], epsrel=1e-12)[0]
    radius = math.sqrt(written_out(x))
    residual = x - radius
    given_back = quad(lambda s: math.sqrt(radius) * (s - residual) ** 1.5, residual, x)[0]
    return math.sqrt(given_back / put_in)


@pytest.mark.parametrize("x", [1.05, 1.415, 2.6, 2.6728, 2.8, 30.0])
def test_restitution_is_the_root_of_the_ratio_of_works(x):
    restitution = BODIES.restitution(velocity_reaching(x), MASS)
    assert restitution == pytest.approx(integrated_restitution(x), rel=1e-7)


def test_law_creates_energy_from_yield_up_to_x_of_2_6728():
    assert BODIES.restitution(velocity_reaching(1.415), MASS) == pytest.approx(1.1008, abs=5e-5)
    assert BODIES.restitution(velocity_reaching(2.6727), MASS) > 1.0
    assert BODIES.restitution(velocity_reaching(2.6729), MASS) < 1.0
    # law leaves a bulge from yield up to x of 1 9983
    signs = [
        BODIES.residual_indentation(x * BODIES.yield_indentation) for x in (1.01, 1.998, 1.9984)
    ]
    assert signs[0] < 0 > signs[1]
    assert signs[2] > 0
    # restitution falls with velocity beyond its peak
    values = [BODIES.restitution(velocity, MASS) for velocity in (0.1, 1.0, 5.0, 20.0, 100.0)]
    assert values == sorted(values, reverse=True)
    assert values[-1] < 0.5 < values[0]


def test_bodies_of_an_impact_yield_at_the_softer_one():
    bodies = stronge_impact(paper_impact())
    assert bodies.yield_stress == 345e6
    assert bodies.effective_radius == 0.035
    assert bodies.effective_modulus == pytest.approx(208e9 * 210e9 / (418e9 * 0.91), rel=1e-12)
