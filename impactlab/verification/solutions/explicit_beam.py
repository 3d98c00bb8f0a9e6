"""The elastic beam under leapfrog: its stability in closed form, and a plain march to see it.

w_tt = -(EI/mu) w_xxxx by second differences twice, simply supported, without contact and without
fibres. Von Neumann's analysis; see e.g. Hughes, The Finite Element Method (1987), section 9.2.

Symbols: dx (m), node spacing; dt (s), time step; EI (N m2); mu (kg/m); omega (1/s), the highest
frequency of the grid; lambda, the factor by which its mode grows each step.
"""

from __future__ import annotations

import math

import numpy as np

from impactlab.model.impact import Beam
from impactlab.types import Floats


def bar_wave_step(beam: Beam, nodes: int) -> float:
    """Return dx/sqrt(E/rho) in s: a bar wave's time over one spacing (the paper's rule)."""
    speed = math.sqrt(beam.material.youngs_modulus / beam.material.density)
    return beam.span / (nodes - 1) / speed


def bending_step(beam: Beam, nodes: int) -> float:
    """Return (dx^2/2) sqrt(mu/EI) in s: 2/omega, from which on bending is unstable."""
    return 2.0 / highest_frequency(beam, nodes)


def highest_frequency(beam: Beam, nodes: int) -> float:
    """Return omega = (4/dx^2) sqrt(EI/mu) in 1/s, of the mode that changes sign at every node.

    An upper bound that the grid reaches but for a factor of 1 - (pi/(2 nodes))^2.
    """
    dx = beam.span / (nodes - 1)
    return 4.0 / dx**2 * math.sqrt(beam.bending_stiffness / beam.mass_per_length)


def growth(frequency: float, dt: float, sign: float = 1.0) -> float:
    """Return |lambda|, the larger root of lambda^2 - (2 - sign (omega dt)^2) lambda + 1 = 0.

    sign: -1 for w_tt = +(EI/mu) w_xxxx, the moment's sign turned round.
    """
    half = abs(0.5 * sign * (frequency * dt) ** 2 - 1.0)
    return 1.0 if half <= 1.0 else half + math.sqrt(half**2 - 1.0)


def march(beam: Beam, nodes: int, dt: float, steps: int, sign: float = 1.0) -> Floats:
    """Return the largest |w| in m after each of `steps` steps of dt, from 1 m/s at mid-span.

    sign: see growth. Steps after an overflow hold infinity.
    """
    dx = beam.span / (nodes - 1)
    stiffness = sign * beam.bending_stiffness / beam.mass_per_length
    w, v = np.zeros(nodes), np.zeros(nodes)
    v[nodes // 2] = 1.0
    largest = np.full(steps, np.inf)
    for step in range(steps):
        w += dt * v
        largest[step] = np.abs(w).max()
        if largest[step] > 1e100:  # far below the floating-point limit
            largest[step:] = np.inf
            break
        curvature = np.zeros(nodes)
        curvature[1:-1] = (w[:-2] - 2.0 * w[1:-1] + w[2:]) / dx**2
        v[1:-1] -= dt * stiffness * (curvature[:-2] - 2.0 * curvature[1:-1] + curvature[2:]) / dx**2
    return largest
