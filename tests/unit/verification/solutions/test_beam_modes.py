"""The modes of both theories against matrix beams, sums, and the start of a step response."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from impactlab.model.impact import paper_impact
from impactlab.verification.solutions.beam_modes import (
    odd_modes,
    shear_stiffness,
    timoshenko_odd_modes,
)

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
def test_modes_left_out_are_the_tails_of_the_series(count):
    modes, many = odd_modes(BEAM, count), odd_modes(BEAM, 200_000)
    tail = many.flexibilities[count:]
    assert modes.residual_flexibility == pytest.approx(tail.sum(), rel=1e-7)
    curvature = -(many.wave_numbers[count:] ** 2) @ tail
    # What 200,000 modes leave out is itself 1.3e-6 of the whole.
    assert modes.residual_curvature == pytest.approx(curvature, rel=1e-3)


STUBBY = replace(BEAM, depth=0.2)
BEAMS = pytest.mark.parametrize("beam", [BEAM, STUBBY], ids=["paper", "stubby"])


def staggered_frequencies(beam, cells):
    """rad/s, ascending: deflections at the inner nodes, rotations at the middles between nodes."""
    dx, EI, a = beam.span / cells, beam.bending_stiffness, shear_stiffness(beam)
    slope = (np.eye(cells, cells - 1) - np.eye(cells, cells - 1, k=-1)) / dx
    shear = np.hstack((slope, -np.eye(cells)))
    # M = 0 at the ends: the inner nodes alone bend.
    bend = np.hstack((np.zeros((cells - 1, cells - 1)), slope.T))
    mu = beam.mass_per_length
    mass = np.repeat([mu, mu * beam.depth**2 / 12], [cells - 1, cells])
    squares = eigh(a * shear.T @ shear + EI * bend.T @ bend, np.diag(mass), eigvals_only=True)
    return np.sqrt(squares)


@BEAMS
def test_timoshenko_frequencies_are_those_of_a_finite_difference_beam(beam):
    coarse, fine = (staggered_frequencies(beam, cells) for cells in (100, 200))
    expected = timoshenko_odd_modes(beam, 3).frequencies.reshape(2, 3)

    def near(frequencies, wanted):
        return frequencies[np.argmin(np.abs(frequencies - wanted))]

    for wanted in expected.ravel():
        # Their error falls with dx^2: so much the better without it.
        rough, found = near(coarse, wanted), near(fine, wanted)
        assert (4 * found - rough) / 3 == pytest.approx(wanted, rel=1e-6)
    # None is missed: the first two odd modes are below all of the higher spectrum.
    np.testing.assert_allclose(fine[[0, 2]], expected[0, :2], rtol=1e-3)


@BEAMS
def test_both_spectra_share_the_mass(beam):
    """A blow F dt sets the deflection off like that of free particles: no spring acts yet."""
    modes = timoshenko_odd_modes(beam, 30)
    shares = (modes.flexibilities * modes.frequencies**2).reshape(2, 30).sum(0)
    np.testing.assert_allclose(shares * beam.mass_per_length * beam.span / 2, 1.0, rtol=1e-13)


@BEAMS
def test_modes_add_up_to_the_static_deflection_curve(beam):
    plain, sheared = odd_modes(beam, 5000), timoshenko_odd_modes(beam, 20_000)
    x, a = np.linspace(0, beam.span / 2, 7), shear_stiffness(beam)
    bending = x * (3 * beam.span**2 - 4 * x**2) / (48 * beam.bending_stiffness)
    for modes, expected, left_out in (
        (plain, bending, 1e-9 * bending[-1]),
        # Sum of 1/n^2 over n > 40,000: what 20,000 modes leave out at the cusp.
        (sheared, bending + x / (2 * a), 1.01 * beam.span / (8e4 * a)),
    ):
        shapes = np.cos(np.outer(modes.wave_numbers, x - beam.span / 2))  # 1 at mid-span
        np.testing.assert_allclose(modes.flexibilities @ shapes, expected, rtol=0, atol=left_out)
        whole = modes.flexibilities.sum() + modes.residual_flexibility
        assert whole == pytest.approx(expected[-1], rel=1e-12)


@BEAMS
def test_timoshenko_modes_left_out_are_the_tails_of_the_series(beam):
    modes, many = timoshenko_odd_modes(beam, 10), timoshenko_odd_modes(beam, 100_000)
    rest = np.ones(200_000, dtype=bool)
    rest[:10] = rest[100_000:100_010] = False
    tail = many.flexibilities[rest].sum()
    assert modes.residual_flexibility == pytest.approx(tail, rel=2e-4)
    curvature = many.curvatures[rest] @ many.flexibilities[rest]
    assert modes.residual_curvature == pytest.approx(curvature, rel=2e-4)


def test_curvatures_are_those_of_the_rotation():
    """Each mode by the second equation: rho I psi_tt = EI psi_xx + a (w_x - psi)."""
    modes, inertia = timoshenko_odd_modes(STUBBY, 8), STUBBY.mass_per_length * STUBBY.depth**2 / 12
    a, q = shear_stiffness(STUBBY), modes.wave_numbers
    turn = a * q / (a + STUBBY.bending_stiffness * q**2 - inertia * modes.frequencies**2)
    np.testing.assert_allclose(modes.curvatures, -q * turn, rtol=1e-9)


@BEAMS
def test_without_shear_and_rotation_the_modes_are_euler_and_bernoullis(beam):
    """Both corrections go with depth^2 at first."""
    plain = odd_modes(beam, 1)
    gaps = []
    for depth in (beam.depth / 10, beam.depth / 20):
        thin = replace(beam, depth=depth)
        bare, full = odd_modes(thin, 1), timoshenko_odd_modes(thin, 1)
        gaps.append(1 - full.frequencies[0] / bare.frequencies[0])
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(2.0, abs=0.01)
    assert plain.frequencies[0] > timoshenko_odd_modes(beam, 1).frequencies[0]
