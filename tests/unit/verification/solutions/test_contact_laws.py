"""The laws of the reference against closed forms, and what they are fitted to."""

import math

import numpy as np
import pytest

import impactlab as il
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.contact_laws import (
    LAWS,
    LawOnHalfSpace,
    StrongeImpact,
    joints,
    law_on_half_space,
)

E, R, S, nu = 115e9, 0.035, 345e6, 0.3
MASS = 1.4
VELOCITIES = [0.005, 0.02, 0.3, 2.0, 20.0]


def law(name):
    return LawOnHalfSpace(name, E, R, S, nu)


@pytest.mark.parametrize("velocity", VELOCITIES)
def test_stronge_by_quadrature_is_stronge_in_closed_form(velocity):
    ours, closed = law("stronge"), StrongeImpact(E, R, S)
    deepest = closed.maximum_indentation(velocity, MASS)
    assert ours.maximum_indentation(velocity, MASS) == pytest.approx(deepest, rel=1e-9)
    assert ours.restitution(velocity, MASS) == pytest.approx(
        closed.restitution(velocity, MASS), rel=1e-8
    )


@pytest.mark.parametrize("velocity", VELOCITIES)
def test_stronges_own_restitution(velocity):
    """Stronge 2000: W_r = (2/5) F_y delta_y (2 delta/delta_y - 1)^1.5."""
    ours, closed = law("stronge_original"), StrongeImpact(E, R, S)
    deepest = closed.maximum_indentation(velocity, MASS)
    x = deepest / closed.yield_indentation
    work = 0.4 * closed.yield_force * closed.yield_indentation * (2.0 * x - 1.0) ** 1.5
    expected = math.sqrt(work / closed.loading_work(deepest)) if x > 1 else 1.0
    assert ours.restitution(velocity, MASS) == pytest.approx(expected, rel=1e-8)


def thornton_restitution(velocity_ratio):
    """e of Thornton's law in closed form (Thornton 1997); velocity over that of first yield."""
    if velocity_ratio <= 1.0:
        return 1.0
    slow = 1.0 / velocity_ratio
    cut = 1.0 - slow**2 / 6.0
    rest = slow / (slow + 2.0 * math.sqrt(1.2 - 0.2 * slow**2))
    return math.sqrt(1.2 * math.sqrt(3.0) * cut) * math.sqrt(math.sqrt(rest))


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.001, 1.5, 5.0, 100.0, 3000.0])
def test_thorntons_restitution_is_his_closed_form(ratio):
    thornton = law("thornton")
    yields = R * (0.8 * math.pi * S / E) ** 2
    velocity = ratio * math.sqrt(2.0 * thornton.loading_work(yields) / MASS)
    expected = thornton_restitution(ratio)
    assert thornton.restitution(velocity, MASS) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("velocity", VELOCITIES)
def test_hertz(velocity):
    deepest = hertz.maximum_indentation(MASS, velocity, E, R)
    assert law("hertz").maximum_indentation(velocity, MASS) == pytest.approx(deepest, rel=1e-9)
    assert law("hertz").restitution(velocity, MASS) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_work_between_joints_is_that_of_many_trapezia(name):
    deepest = 1.7 * joints(E, R, S, nu)[-1]
    depths = np.unique(np.concatenate([np.linspace(0.0, deepest, 40001)[1:], [1e-12]]))
    forces = np.array([law(name).loading_force(depth) for depth in depths.tolist()])
    assert law(name).loading_work(deepest) == pytest.approx(np.trapezoid(forces, depths), rel=1e-5)


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"hertz", "thornton"}))
def test_fully_plastic_pressure_is_about_2_8_yield_stresses(name):
    """All but Thornton agree on this; a^2 = 2 R delta, as for a rigid sphere in plastic ground."""
    delta = 250.0 * R * (0.8 * math.pi * S / E) ** 2
    pressure = law(name).loading_force(delta) / (math.pi * 2.0 * R * delta)
    assert pressure == pytest.approx(2.8 * S, rel=0.15)


@pytest.mark.parametrize("name", LAWS)
def test_bodies_of_an_impact(name):
    ours = law_on_half_space(il.paper_impact(contact=name))
    assert (ours.law, ours.yield_stress, ours.poissons_ratio) == (name, 345e6, 0.3)
    assert ours.effective_modulus == hertz.effective_modulus(il.paper_impact())
