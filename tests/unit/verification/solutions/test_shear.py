"""Closed forms of shear against integrals, the exact frequency equation and small numbers."""

from dataclasses import replace

import pytest
from scipy.integrate import quad

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions import beam_modes, bending

BEAM = paper_impact().beam


def modulus_ratio(beam):
    """E/(k G)."""
    return beam.material.youngs_modulus * beam.width * beam.depth / beam_modes.shear_stiffness(beam)


def static_share(beam):
    """Static deflection by shear over that by bending: 12 EI/(k G A L^2).

    Equals E/(k G) (H/L)^2; 3.12 (H/L)^2 for nu = 0.3. Where it is small, shear does not matter to
    motions as slow as the beam's first mode; to a contact it may matter all the same.
    """
    return modulus_ratio(beam) * (beam.depth / beam.span) ** 2


def test_shear_stiffness_of_the_papers_beam():
    assert beam_modes.shear_stiffness(BEAM) == pytest.approx(5 / 6 * 210e9 / 2.6 * 0.06 * 0.0278)
    other = replace(BEAM, shear_coefficient=0.5)
    assert beam_modes.shear_stiffness(other) == pytest.approx(
        0.6 * beam_modes.shear_stiffness(BEAM)
    )
    # tau = 1.5 (1 - xi^2) of the mean: its energy over that of the mean is 1/k.
    energy, _ = quad(lambda xi: 0.5 * (1.5 * (1 - xi**2)) ** 2, -1, 1)
    assert BEAM.shear_correction == pytest.approx(1 / energy)


def test_static_deflection_by_the_unit_load():
    """Integral of M m/(EI) + Q q/(a), M = P x/2 and Q = P/2 up to mid-span."""
    load, a, EI = 1e3, beam_modes.shear_stiffness(BEAM), BEAM.bending_stiffness
    work, _ = quad(lambda x: load * x / 2 * x / 2 / EI + load / 4 / a, 0, BEAM.span / 2)
    bent, sheared = bending.static_deflection(BEAM, load), beam_modes.shear_deflection(BEAM, load)
    assert bent + sheared == pytest.approx(2 * work, rel=1e-12)
    assert sheared / bent == pytest.approx(static_share(BEAM), rel=1e-12)
    assert static_share(BEAM) == pytest.approx(3.12 * (0.0278 / 0.78) ** 2, rel=1e-12)
