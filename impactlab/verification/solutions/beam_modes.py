"""Odd modes of the simply supported beam loaded at mid-span; here those of Euler and Bernoulli.

y_n (m) is the mid-span deflection in mode n: y_n'' + omega_n^2 y_n = F/m_n, in this theory with
m_n = rho A L/2 (kg). Even modes have a node at mid-span and are not excited. The modes left out
follow the load F (N) statically, so that any number of modes has the right static deflection,
F L^3/(48 EI) and what shear adds to it.
Source: Timoshenko, Vibration Problems in Engineering, on forced vibrations of beams.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impactlab.model.beam import Beam
from impactlab.model.checks import integer

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BeamModes:
    """Constants of the first odd modes, each of shape (modes,).

    wave_numbers: n pi/L in 1/m. frequencies: omega_n in rad/s. flexibilities: 1/(m_n omega_n^2) in
    m/N. curvatures: of bending at mid-span, over y_n, in 1/m2. shear_compliance: 1/(k G A) in 1/N,
    zero where shear does not deform the beam.
    """

    beam: Beam
    wave_numbers: Floats
    frequencies: Floats
    flexibilities: Floats
    curvatures: Floats
    shear_compliance: float = 0.0

    @property
    def residual_flexibility(self) -> float:
        """Mid-span deflection per load of the modes left out, in m/N."""
        bending = self.beam.span**3 / (48.0 * self.beam.bending_stiffness)
        whole = bending + 0.25 * self.beam.span * self.shear_compliance
        return float(whole - self.flexibilities.sum())

    @property
    def residual_curvature(self) -> float:
        """Mid-span curvature per load of the modes left out, in 1/(m N)."""
        whole = -self.beam.span / (4.0 * self.beam.bending_stiffness)
        return float(whole - self.curvatures @ self.flexibilities)

    def shapes(self, x: Floats) -> Floats:
        """Mode shapes, 1 at mid-span, at `x` (m from a support, shape (x,)): shape (modes, x)."""
        signs = np.sign(np.sin(0.5 * self.beam.span * self.wave_numbers))
        return np.asarray(signs[:, np.newaxis] * np.sin(np.outer(self.wave_numbers, x)))

    def residual_shape(self, x: Floats) -> Floats:
        """Deflection per load of the modes left out at `x` (m, shape (x,)), in m/N."""
        near = np.minimum(x, self.beam.span - x)
        cubic = near * (3.0 * self.beam.span**2 - 4.0 * near**2)
        bending = cubic / (48.0 * self.beam.bending_stiffness)
        whole = bending + 0.5 * near * self.shear_compliance
        return np.asarray(whole - self.flexibilities @ self.shapes(x))


def odd_modes(beam: Beam, count: int) -> BeamModes:
    """The first `count` odd modes of the Euler-Bernoulli beam: n = 1, 3, 5, ...

    Raises ValueError when count is not a whole number of at least 1.
    """
    wave_numbers = odd_wave_numbers(beam, count)
    squares = wave_numbers**2
    frequencies = squares * math.sqrt(beam.bending_stiffness / beam.mass_per_length)
    mass = 0.5 * beam.mass_per_length * beam.span
    return BeamModes(beam, wave_numbers, frequencies, 1.0 / (mass * frequencies**2), -squares)


def odd_wave_numbers(beam: Beam, count: int) -> Floats:
    """n pi/L in 1/m for the first `count` odd n, shape (count,).

    Raises ValueError when count is not a whole number of at least 1.
    """
    last = 2 * integer("odd_modes", "count", count, 1) - 1
    return np.arange(1, last + 1, 2, dtype=np.float64) * (math.pi / beam.span)
