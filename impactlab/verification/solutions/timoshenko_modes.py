"""Odd modes of the simply supported Timoshenko beam loaded at mid-span.

rho A w_tt = Q_x + p, rho I psi_tt = M_x + Q, Q = a (w_x - psi), M = EI psi_x, a = k G A;
w = M = 0 at both ends. With w = W sin(q x), psi = Psi cos(q x), q = n pi/L, and the load 2 F/L of a
point load F (N) at mid-span (signs as in BeamModes.shapes), n odd:

    rho A W'' = -a q (q W - Psi) + 2 F/L,   rho I Psi'' = a (q W - Psi) - EI q^2 Psi,

two coupled oscillators, and so two frequencies for each n: mostly deflection, and mostly rotation.
Source: S. Timoshenko, Phil. Mag. 43 (1922) 125; the second spectrum: R. W. Traill-Nash and
A. R. Collar, Q. J. Mech. Appl. Math. 6 (1953) 186.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impactlab.model.beam import Beam
from impactlab.verification.solutions.beam_modes import BeamModes, odd_wave_numbers
from impactlab.verification.solutions.shear import shear_stiffness

Floats = NDArray[np.float64]


def odd_modes(beam: Beam, count: int) -> BeamModes:
    """Both spectra of the first `count` odd n: first the lower frequencies, then the higher ones.

    Mode masses: 1/m = 2/(rho A L) times W's share in the mode, the square of W's entry in the unit
    eigenvector of (sqrt(rho A) W, sqrt(rho I) Psi); the shares of one n add up to 1. Curvatures:
    psi_x = -q Psi, q Psi = (q^2 - rho A omega^2/a) W, by the first equation without load.

    Raises ValueError when count is not a whole number of at least 1.
    """
    q, a = odd_wave_numbers(beam, count), shear_stiffness(beam)
    squares, shares = _two_oscillators(beam, q, a)
    flexibilities = 2.0 * shares / (beam.mass_per_length * beam.span * squares)
    curvatures = beam.mass_per_length * squares / a - q**2
    return BeamModes(
        beam,
        np.tile(q, 2),
        np.sqrt(squares).ravel(),
        flexibilities.ravel(),
        curvatures.ravel(),
        1.0 / a,
    )


def _two_oscillators(beam: Beam, q: Floats, a: float) -> tuple[Floats, Floats]:
    """omega^2 (1/s2) and W's share in each of the two spectra, shape (2, n).

    Eigenvalues and vectors of ((r, -c), (-c, p)), r and p the squares of each oscillator's own
    frequency, where p > r; lower root and smaller share without taking differences.
    """
    EI, mu = beam.bending_stiffness, beam.mass_per_length
    inertia = mu * beam.depth**2 / 12.0
    r, p = a * q**2 / mu, (a + EI * q**2) / inertia
    half, coupling = 0.5 * (p - r), (a * q) ** 2 / (mu * inertia)
    root = np.sqrt(half**2 + coupling)
    upper = 0.5 * (p + r) + root
    lower = a * EI * q**4 / (mu * inertia) / upper
    small = coupling / (2.0 * root * (root + half))
    return np.stack((lower, upper)), np.stack((1.0 - small, small))
