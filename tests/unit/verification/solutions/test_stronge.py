"""The Stronge law's closed forms against integrals of the force, over depth and over time."""

import math

import pytest

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


def test_restitution_is_one_up_to_yield():
    work = 0.4 * BODIES.yield_force * BODIES.yield_indentation
    limit = math.sqrt(2.0 * work / MASS)
    assert BODIES.restitution(0.5 * limit, MASS) == pytest.approx(1.0, abs=1e-14)
    assert BODIES.restitution(limit * (1 + 1e-9), MASS) == pytest.approx(1.0, abs=1e-6)
    assert BODIES.residual_indentation(0.9 * BODIES.yield_indentation) == 0.0


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
