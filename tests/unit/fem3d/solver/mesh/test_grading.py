"""Graded lines: where they begin, how they grow, where they end."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.fem3d.solver.mesh.mesh import graded


@pytest.mark.parametrize("length", [4.2, 5.0, 11.7, 390.0])
def test_fine_first_then_growing_by_no_more_than_the_ratio(length):
    points = graded(0.5, 3.0, length, 1.3, 4.0)
    steps = np.diff(points)
    assert points[0] == 0.0
    assert points[-1] == length
    np.testing.assert_allclose(points[:7], 0.5 * np.arange(7))
    assert steps.min() > 0.45
    assert steps.max() <= 4.0 * (1 + 1e-9)
    assert np.all(steps[7:] / steps[6:-1] < 1.3 * (1 + 1e-9))
    assert np.all(steps[7:] >= steps[6:-1] * (1 - 1e-9))


def test_what_is_fine_all_along_is_even():
    np.testing.assert_allclose(graded(0.4, 3.0, 2.0, 1.3, 4.0), np.linspace(0.0, 2.0, 6))
