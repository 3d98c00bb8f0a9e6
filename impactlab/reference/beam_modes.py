"""Odd modes of the simply supported Euler-Bernoulli beam loaded at mid-span.

y_n (m) is the mid-span deflection in mode n: y_n'' + omega_n^2 y_n = F/m, m = rho A L/2 (kg). Even
modes have a node at mid-span and are not excited. The modes left out follow the load F (N)
statically, so that any number of modes has the right static deflection F L^3/(48 EI).
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

    wave_numbers: n pi/L in 1/m. frequencies: omega_n in rad/s. flexibilities: 1/(m omega_n^2) in
    m/N.
    """

    beam: Beam
    wave_numbers: Floats
    frequencies: Floats
    flexibilities: Floats

    @property
    def residual_flexibility(self) -> float:
        """Mid-span deflection per load of the modes left out, in m/N."""
        whole = self.beam.span**3 / (48.0 * self.beam.bending_stiffness)
        return float(whole - self.flexibilities.sum())

    @property
    def residual_curvature(self) -> float:
        """Mid-span w_xx per load of the modes left out, in 1/(m N)."""
        whole = -self.beam.span / (4.0 * self.beam.bending_stiffness)
        return float(whole + self.wave_numbers**2 @ self.flexibilities)

    def shapes(self, x: Floats) -> Floats:
        """Mode shapes, 1 at mid-span, at `x` (m from a support, shape (x,)): shape (modes, x)."""
        signs = (-1.0) ** np.arange(self.wave_numbers.size)
        return np.asarray(signs[:, np.newaxis] * np.sin(np.outer(self.wave_numbers, x)))

    def residual_shape(self, x: Floats) -> Floats:
        """Deflection per load of the modes left out at `x` (m, shape (x,)), in m/N."""
        near = np.minimum(x, self.beam.span - x)
        whole = (
            near * (3.0 * self.beam.span**2 - 4.0 * near**2) / (48.0 * self.beam.bending_stiffness)
        )
        return np.asarray(whole - self.flexibilities @ self.shapes(x))


def odd_modes(beam: Beam, count: int) -> BeamModes:
    """The first `count` odd modes of `beam`: n = 1, 3, 5, ...

    Raises ValueError when count is not a whole number of at least 1.
    """
    last = 2 * integer("odd_modes", "count", count, 1) - 1
    wave_numbers = np.arange(1, last + 1, 2, dtype=np.float64) * (math.pi / beam.span)
    frequencies = wave_numbers**2 * math.sqrt(beam.bending_stiffness / beam.mass_per_length)
    mass = 0.5 * beam.mass_per_length * beam.span
    return BeamModes(beam, wave_numbers, frequencies, 1.0 / (mass * frequencies**2))
