"""The beam's modes against a matrix beam and the static deflection curve."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.model.paper import paper_impact
from impactlab.verification.solutions.beam_modes import odd_modes

BEAM = paper_impact().beam
STIFFNESS = 210e9 * 0.06 * 0.0278**3 / 12


def test_frequencies_are_those_of_a_finite_difference_beam():
    cells = 400
    second = (np.diag(np.full(cells - 1, -2.0)) + np.eye(cells - 1, k=1)) + np.eye(cells - 1, k=-1)
    second *= (cells / BEAM.span) ** 2
    mass_per_length = 7800 * 0.06 * 0.0278
    squares = np.linalg.eigvalsh(STIFFNESS / mass_per_length * second @ second)
    frequencies = np.sqrt(squares[[0, 2, 4]])
    np.testing.assert_allclose(odd_modes(BEAM, 3).frequencies, frequencies, rtol=2e-4)


@pytest.mark.parametrize("count", [1, 3, 50])
def test_any_number_of_modes_has_the_static_deflection_curve(count):
    modes, x = odd_modes(BEAM, count), np.linspace(0, BEAM.span / 2, 7)
    curve = modes.flexibilities @ modes.shapes(x) + modes.residual_shape(x)
    many = odd_modes(BEAM, 5000)
    np.testing.assert_allclose(curve, many.flexibilities @ many.shapes(x), rtol=1e-9, atol=1e-16)
    mirrored = modes.flexibilities @ modes.shapes(BEAM.span - x)
    mirrored += modes.residual_shape(BEAM.span - x)
    np.testing.assert_allclose(mirrored, curve, rtol=1e-9, atol=1e-16)


@pytest.mark.parametrize("count", [1, 3, 50])
def test_modes_left_out_are_the_tails_of_the_series(count):
    modes, many = odd_modes(BEAM, count), odd_modes(BEAM, 200_000)
    tail = many.flexibilities[count:]
    assert modes.residual_flexibility == pytest.approx(tail.sum(), rel=1e-7)
    curvature = -(many.wave_numbers[count:] ** 2) @ tail
    # What 200,000 modes leave out is itself 1.3e-6 of the whole.
    assert modes.residual_curvature == pytest.approx(curvature, rel=1e-3)


def test_number_of_modes_is_checked():
    with pytest.raises(ValueError, match="count"):
        odd_modes(BEAM, 0)
