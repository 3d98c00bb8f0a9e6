"""The modes of both theories against matrix beams, sums, and the start of a step response."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
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
def test_frequencies_solve_timoshenkos_equation(beam):
    modes, mu, EI = timoshenko_odd_modes(beam, 20), beam.mass_per_length, beam.bending_stiffness
    a, q, omega = shear_stiffness(beam), modes.wave_numbers, modes.frequencies
    inertia = mu * beam.depth**2 / 12
    terms = np.stack(
        (
            EI * q**4,
            -mu * omega**2,
            -(inertia + EI * mu / a) * q**2 * omega**2,
            mu * inertia / a * omega**4,
        )
    )
    assert np.all(np.abs(terms.sum(0)) < 1e-12 * np.abs(terms).max(0))


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


def early_deflection(beam, load, time):
    """Deflection in m under a `load` F (N) that set on suddenly, a short `time` t (s) ago.

    w = F (t/(2 sqrt(a rho A)) + t^3/(24 EI p (p + b)^2)) + O(t^5): first the load meets the
    impedance of two shear waves, then sections begin to turn. p, b: slownesses (s/m) of the shear
    wave, sqrt(rho/(k G)), and of the bar wave, sqrt(rho/E).
    From the Laplace and Fourier transform of the infinite beam,
    W = F/s * 1/(X - a^2 q^2/(Y + a)), X = rho A s^2 + a q^2, Y = rho I s^2 + EI q^2, for large s
    F/s (1/X + a^2 q^2/(X^2 Y) + ...), integrated over q/(2 pi).
    """
    force, t = load, time
    a = shear_stiffness(beam)
    shear = np.sqrt(beam.mass_per_length / a)
    bar = np.sqrt(beam.material.density / beam.material.youngs_modulus)
    first = t / (2.0 * np.sqrt(a * beam.mass_per_length))
    third = t**3 / (24.0 * beam.bending_stiffness * shear * (shear + bar) ** 2)
    return force * (first + third)


def step_response(beam, times, count):
    """Deflection over a suddenly applied load in m/N, shape (time,)."""
    modes = timoshenko_odd_modes(beam, count)
    moving = (1 - np.cos(np.outer(times, modes.frequencies))) @ modes.flexibilities
    return moving + modes.residual_flexibility  # their cosines even out


@BEAMS
def test_a_load_first_meets_the_impedance_of_two_shear_waves(beam):
    """No wave has crossed the depth yet; the next term of the series goes with t^5."""
    crossing = beam.depth / np.sqrt(beam.material.youngs_modulus / beam.material.density)
    times = crossing * np.array([0.2, 0.4])
    found = step_response(beam, times, 100_000)
    expected = np.array([early_deflection(beam, 1.0, t) for t in times])
    impedance = 2 * np.sqrt(shear_stiffness(beam) * beam.mass_per_length)
    np.testing.assert_allclose(found, times / impedance, rtol=0.1)
    np.testing.assert_allclose(found, expected, rtol=2e-3)
    # The cubic term is seen: without it the difference is many times larger.
    assert np.all(np.abs(found - expected) < 0.1 * np.abs(found - times / impedance))


def test_cubic_term_of_the_early_deflection():
    """Its coefficient over 6, by quadrature of a^2 x^2/((mu + a x^2)^2 (J + EI x^2))/(2 pi)."""
    a, mu, EI = shear_stiffness(BEAM), BEAM.mass_per_length, BEAM.bending_stiffness
    inertia, scale = mu * BEAM.depth**2 / 12, np.sqrt(mu / a)

    def integrand(y):
        x = scale * y
        return a**2 * x**2 / ((mu + a * x**2) ** 2 * (inertia + EI * x**2)) * scale

    integral, _ = quad(integrand, -np.inf, np.inf)
    t = 1e-6
    cubic = early_deflection(BEAM, 1.0, t) - t / (2 * np.sqrt(a * mu))
    assert cubic == pytest.approx(integral / (2 * np.pi) * t**3 / 6, rel=1e-6)
