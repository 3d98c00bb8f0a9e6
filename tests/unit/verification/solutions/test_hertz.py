"""Hertz's closed forms against the equation of motion integrated in time."""

import pytest

from impactlab.model.impact import paper_impact
from impactlab.verification.cases import timoshenko_impact
from impactlab.verification.solutions import hertz

MASS, VELOCITY, MODULUS, RADIUS = 1.4, 2.0, 1.15e11, 0.035


def test_effective_modulus_of_like_bodies_is_half_the_plane_strain_one():
    steel = timoshenko_impact().beam.material
    expected = steel.youngs_modulus / (2 * (1 - 0.3**2))
    assert hertz.effective_modulus(timoshenko_impact()) == pytest.approx(expected, rel=1e-12)
    assert hertz.effective_modulus(paper_impact()) == pytest.approx(
        208e9 * 210e9 / (418e9 * 0.91), rel=1e-12
    )
