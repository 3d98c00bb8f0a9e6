"""Closed forms of bending against integrals over the depth, hand calculation and fibres."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions import bending
from impactlab.verification.solutions.bending import rule

BEAM = paper_impact().beam
HARDENING = replace(
    BEAM,
    material=replace(
        BEAM.material, isotropic_hardening_modulus=5e9, kinematic_hardening_modulus=3e9
    ),
)
KAPPA_Y = bending.yield_curvature(BEAM)


def stress(material, strain):
    """Hardening law read off its definition: beyond yield the plastic strain adds h per unit."""
    h = material.isotropic_hardening_modulus + material.kinematic_hardening_modulus
    excess = max(material.youngs_modulus * strain - material.yield_stress, 0.0)
    plastic_strain = excess / (material.youngs_modulus + h)
    return material.youngs_modulus * (strain - plastic_strain)


def integrated_moment(beam, kappa):
    edge = bending.yield_curvature(beam) / kappa * beam.depth / 2
    half, _ = quad(
        lambda z: stress(beam.material, z * kappa) * z,
        0,
        beam.depth / 2,
        points=[edge] if edge < beam.depth / 2 else None,
        epsrel=1e-12,
    )
    return 2 * beam.width * half


@pytest.mark.parametrize("beam", [BEAM, HARDENING], ids=["perfect", "hardening"])
@pytest.mark.parametrize("ratio", [0.3, 1.0, 1.01, 2.0, 50.0])
def test_moment_is_the_integral_over_the_depth(beam, ratio):
    kappa = ratio * KAPPA_Y
    expected = integrated_moment(beam, kappa)
    assert float(bending.moment(beam, kappa)) == pytest.approx(expected, rel=1e-10)
    assert float(bending.moment(beam, -kappa)) == pytest.approx(-expected, rel=1e-10)


def test_moment_at_first_yield_and_in_the_limit():
    at_yield, far = bending.moment(BEAM, [KAPPA_Y, 1e4 * KAPPA_Y])
    assert at_yield == pytest.approx(bending.yield_moment(BEAM), rel=1e-12)
    assert far == pytest.approx(bending.plastic_moment(BEAM), rel=1e-8)
    assert bending.plastic_moment(BEAM) == pytest.approx(1.5 * bending.yield_moment(BEAM))
    strain = KAPPA_Y * BEAM.depth / 2
    assert strain * BEAM.material.youngs_modulus == pytest.approx(BEAM.material.yield_stress)
    reaction = bending.collapse_load(BEAM) / 2
    assert reaction * BEAM.span / 2 == pytest.approx(345e6 * 0.06 * 0.0278**2 / 4, rel=1e-12)


E, S_Y, H = 210e9, 345e6, 10e9
TANGENT = E * H / (E + H)


def hardening_beam(**moduli):
    return replace(BEAM, material=replace(BEAM.material, **moduli))


KINDS = {
    "none": hardening_beam(),
    "isotropic": hardening_beam(isotropic_hardening_modulus=H),
    "kinematic": hardening_beam(kinematic_hardening_modulus=H),
}


@pytest.mark.parametrize("kind", KINDS)
def test_reversed_loading_by_hand(kind):
    """To 5 yield strains, back until yield, and one yield strain farther."""
    material, y = KINDS[kind].material, S_Y / E
    tangent = 0.0 if kind == "none" else TANGENT
    top = S_Y + tangent * 4 * y
    radius = top if kind == "isotropic" else S_Y
    turn_yield = 5 * y - 2 * radius / E
    path = np.array([5 * y, turn_yield, turn_yield - y])
    expected = [top, top - 2 * radius, top - 2 * radius - tangent * y]
    assert bending.path_stresses(material, path) == pytest.approx(expected, rel=1e-12)
    assert bending.path_stresses(material, path[[0, 2]])[1] == pytest.approx(expected[2], rel=1e-12)


@pytest.mark.parametrize("kind", ["none", "kinematic"])
def test_masings_rule_is_the_limit_of_fibres(kind):
    turn = 6 * bending.yield_curvature(BEAM)
    path = np.concatenate([[turn], np.linspace(turn, -turn, 30)])
    fibres = bending.path_moments(KINDS[kind], path, *rule("legendre", 2000))
    exact = bending.moment_after_turn(KINDS[kind], turn, path[1:])
    scale = np.abs(exact).max()
    assert fibres[1:] == pytest.approx(exact, abs=1e-6 * scale)


def test_both_kinds_of_hardening_are_refused():
    both = hardening_beam(isotropic_hardening_modulus=H, kinematic_hardening_modulus=H)
    with pytest.raises(ValueError, match="not both"):
        bending.path_stresses(both.material, [0.0])
