"""The infinite beam against the modal sum of a long one, before the supports' echo."""

import numpy as np
import pytest
from scipy.special import beta

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions.bending import (
    curvature_under_force,
    deflection_under_force,
    deflection_under_impulse,
)

BEAM = paper_impact().beam


@pytest.mark.parametrize("power", [1.0, 2.5])
def test_a_growing_force_as_euler_integrates_it(power):
    """For F = t^p both histories are Beta functions."""
    time = np.linspace(0.0, 1e-3, 2001)
    at = slice(200, -1)  # before, one line is no curve
    unit = deflection_under_impulse(BEAM, 1.0, 1.0)
    w = deflection_under_force(BEAM, time, time**power)
    expected = unit * beta(power + 1, 1.5) * time ** (power + 1.5)
    np.testing.assert_allclose(w[at], expected[at], rtol=1e-4)
    k = np.sqrt(BEAM.bending_stiffness / BEAM.mass_per_length)
    curvature = curvature_under_force(BEAM, time, time**power)
    np.testing.assert_allclose(curvature[at], -np.gradient(expected, time)[at] / k, rtol=2e-4)


def test_a_short_force_is_an_impulse():
    time = np.array([0.0, 1e-7, 2e-7, 1e-3])
    w = deflection_under_force(BEAM, time, np.array([0.0, 2e7, 0.0, 0.0]))
    assert w[-1] == pytest.approx(deflection_under_impulse(BEAM, 2.0, 1e-3), rel=1e-4)
    # deflection grows with the root of time from zero
    w = deflection_under_impulse(BEAM, 1.0, [0.0, 1e-3, 4e-3])
    assert w[0] == 0.0
    assert w[2] == pytest.approx(2 * w[1], rel=1e-12)
