"""A beam of one degree of freedom, or none: the spring-mass model and the rigid beam.

m_b w'' = F - k w, with the mid-span's static stiffness k = 48 EI/L^3 and the mass 17/35 rho A L
that has the kinetic energy of the static shape (Rayleigh). Source: Wang et al., the rival that the
paper names. The deflection between support and mid-span is the static one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import Beam, Grid, mirror
from impactlab.solver.jit import allocating, compiled
from impactlab.solver.types import RIGID, Array, Record


class Lumped(NamedTuple):
    """Mass (kg; 0: the beam does not move), stiffness (N/m), static shape.

    shape: 1 at mid-span, (n + 4,).
    """

    mass: float
    stiffness: float
    shape: Array


@compiled
def mid_span(case: Record, EI: float) -> tuple[float, float]:
    """Return (generalised mass in kg, static stiffness in N/m) of the mid-span."""
    beam = case.beam_density * case.beam_width * case.beam_depth * case.beam_span
    return 17.0 / 35.0 * beam, 48.0 * EI / case.beam_span**3


@allocating
def make_lumped(case: Record, EI: float, grid: Grid) -> Lumped:
    """Return the model of a case's beam; EI: the section's (N m2).

    The static shape is that of finite differences: curvature linear in the distance.
    """
    mid = grid.mid
    shape, drop = np.zeros(mid + 3), np.zeros(mid + 3)
    if case.beam_model == RIGID:
        return Lumped(0.0, 0.0, shape)
    drop[mid - 1] = 0.5  # below mid-span, in curvatures there times dx^2
    for i in range(mid - 1, 1, -1):
        drop[i - 1] = 2.0 * drop[i] - drop[i + 1] + (i - 1.0) / (mid - 1.0)
    for i in range(1, mid + 1):
        shape[i] = 1.0 - drop[i] / drop[1]
    mass, stiffness = mid_span(case, EI)
    return Lumped(mass, stiffness, shape)


@compiled
def lumped_step(beam: Beam, lumped: Lumped, grid: Grid, now: int, F: float) -> None:
    """Move the beam by one step under the contact force F (N)."""
    mid = grid.mid
    if lumped.mass > 0.0:
        beam.du[mid] = grid.dt**2 / lumped.mass * (F - lumped.stiffness * beam.w[now, mid])
    beam.u[mid] += beam.du[mid]
    w_mid = beam.w[now, mid] + beam.u[mid]
    for i in range(2, mid + 1):
        beam.w[1 - now, i] = lumped.shape[i] * w_mid
    beam.w[1 - now, mid] = w_mid
    mirror(beam.w, now, grid)


@compiled
def lumped_energy(beam: Beam, lumped: Lumped, grid: Grid, now: int) -> float:
    """Return kinetic (see beam.py) and elastic energy in J, after a step, at its beginning."""
    u, w = beam.u[grid.mid], beam.w[now, grid.mid]
    moving = lumped.mass * u * (u - beam.du[grid.mid]) / grid.dt**2
    return 0.5 * (moving + lumped.stiffness * w * w)
