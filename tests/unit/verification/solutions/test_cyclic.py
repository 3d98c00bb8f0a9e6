"""Stresses to and fro against hand calculation, and Masing's rule against fibres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from impactlab.model.paper import paper_impact
from impactlab.verification.solutions import bending, cyclic
from impactlab.verification.solutions.quadrature import rule

BEAM = paper_impact().beam
E, S_Y, H = 210e9, 345e6, 10e9
TANGENT = E * H / (E + H)


def beam(**moduli):
    return replace(BEAM, material=replace(BEAM.material, **moduli))


KINDS = {
    "none": beam(),
    "isotropic": beam(isotropic_hardening_modulus=H),
    "kinematic": beam(kinematic_hardening_modulus=H),
}


@pytest.mark.parametrize("kind", KINDS)
def test_first_loading_is_the_monotone_law(kind):
    material = KINDS[kind].material
    strains = np.linspace(0, 8, 50) * S_Y / E
    expected = bending.fibre_stress(material, strains)
    for sign in (1, -1):
        found = cyclic.fibre_stresses(material, sign * strains)
        assert found == pytest.approx(sign * expected, rel=1e-12)


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
    assert cyclic.fibre_stresses(material, path) == pytest.approx(expected, rel=1e-12)
    assert cyclic.fibre_stresses(material, path[[0, 2]])[1] == pytest.approx(expected[2], rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_large_steps_are_exact(kind):
    material, y = KINDS[kind].material, S_Y / E
    legs = [np.linspace(a, b, 50)[1:] for a, b in ((0, 4), (4, -3), (-3, 2))]
    fine = cyclic.fibre_stresses(material, np.concatenate(legs) * y)
    coarse = cyclic.fibre_stresses(material, np.array([4, -3, 2]) * y)
    assert coarse == pytest.approx(fine[[48, 97, 146]], rel=1e-12)


@pytest.mark.parametrize("kind", ["none", "kinematic"])
def test_masings_rule_is_the_limit_of_fibres(kind):
    turn = 6 * bending.yield_curvature(BEAM)
    path = np.concatenate([[turn], np.linspace(turn, -turn, 30)])
    fibres = cyclic.rule_moments(KINDS[kind], path, *rule("legendre", 2000))
    exact = cyclic.moment_after_turn(KINDS[kind], turn, path[1:])
    scale = np.abs(exact).max()
    assert fibres[1:] == pytest.approx(exact, abs=1e-6 * scale)


def test_rule_moments_are_the_monotone_ones_on_the_way_out():
    kappa = np.linspace(0, 9, 30) * bending.yield_curvature(BEAM)
    found = cyclic.rule_moments(KINDS["isotropic"], kappa, *rule("lobatto", 9))
    expected = bending.rule_moment(KINDS["isotropic"], kappa, *rule("lobatto", 9))
    assert found == pytest.approx(expected, rel=1e-12)


def test_both_kinds_of_hardening_are_refused():
    both = beam(isotropic_hardening_modulus=H, kinematic_hardening_modulus=H)
    with pytest.raises(ValueError, match="not both"):
        cyclic.fibre_stresses(both.material, [0.0])
