"""Closed forms of bending against integrals over the depth and published limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.model.paper import paper_impact
from impactlab.verification.solutions import bending
from impactlab.verification.solutions.quadrature import rule

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


def test_yield_curvature_brings_the_outer_fibre_to_yield():
    strain = KAPPA_Y * BEAM.depth / 2
    assert strain * BEAM.material.youngs_modulus == pytest.approx(BEAM.material.yield_stress)


def test_collapse_load_makes_the_plastic_moment_at_midspan():
    reaction = bending.collapse_load(BEAM) / 2
    assert reaction * BEAM.span / 2 == pytest.approx(345e6 * 0.06 * 0.0278**2 / 4, rel=1e-12)


def test_static_deflection_is_the_double_integral_of_the_curvature():
    load, half = 1e3, BEAM.span / 2
    # Unit-load theorem: w = 2/EI * integral of (P x/2) (x/2) over half the span.
    work, _ = quad(lambda x: (load * x / 2) * (x / 2), 0, half)
    expected = 2 * work / (210e9 * 0.06 * 0.0278**3 / 12)
    assert bending.static_deflection(BEAM, load) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("beam", [BEAM, HARDENING], ids=["perfect", "hardening"])
@pytest.mark.parametrize("name", ["lobatto", "legendre", "layers"])
def test_fine_rule_tends_to_the_closed_form(beam, name):
    kappa = np.array([-3.0, -0.5, 0.0, 0.9, 1.7, 6.0]) * KAPPA_Y
    moment = bending.rule_moment(beam, kappa, *rule(name, 200))
    np.testing.assert_allclose(moment, bending.moment(beam, kappa), rtol=2e-3)


@pytest.mark.parametrize("name", ["lobatto", "legendre"])
def test_gauss_rules_of_three_points_are_exact_while_elastic(name):
    moment = bending.rule_moment(BEAM, 0.9 * KAPPA_Y, *rule(name, 3))
    assert float(moment) == pytest.approx(0.9 * bending.yield_moment(BEAM), rel=1e-12)


def test_two_lobatto_points_are_three_times_too_stiff():
    moment = bending.rule_moment(BEAM, 0.9 * KAPPA_Y, *rule("lobatto", 2))
    assert float(moment) == pytest.approx(3 * 0.9 * bending.yield_moment(BEAM), rel=1e-12)


def test_three_lobatto_points_have_their_plastic_moment_at_the_yield_moment():
    moment = bending.rule_moment(BEAM, 20 * KAPPA_Y, *rule("lobatto", 3))
    assert float(moment) == pytest.approx(bending.yield_moment(BEAM), rel=1e-12)


def test_wrong_values_are_named():
    with pytest.raises(ValueError, match="curvature"):
        bending.moment(BEAM, [0.0, np.nan])
    with pytest.raises(ValueError, match="weights"):
        bending.rule_moment(BEAM, 0.1, [-1.0, 1.0], [1.0])
    with pytest.raises(ValueError, match="load"):
        bending.static_deflection(BEAM, -1.0)
    with pytest.raises(ValueError, match="strain"):
        bending.fibre_stress(BEAM.material, np.inf)
