"""A beam of one degree of freedom, or none: the spring-mass model and the rigid beam.

m_b w'' = F - k w, with the mid-span's static stiffness k = 48 EI/L^3 and the mass 17/35 rho A L
that has the kinetic energy of the static shape (Rayleigh). Source: Wang et al., the rival that the
paper names. The deflection between support and mid-span is the static one.
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import BeamGrid, mirror, rest_beam
from impactlab.solver.euler_bernoulli import MODEL as EULER_BERNOULLI
from impactlab.solver.euler_bernoulli import deflected
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.section import FibreSection
from impactlab.solver.state import BeamModel, State
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
    beam = case.mass_per_length * case.beam_span
    return 17.0 / 35.0 * beam, 48.0 * EI / case.beam_span**3


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Lumped:
    """Return the model of a case's beam.

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
    mass, stiffness = mid_span(case, section.stiffness)
    return Lumped(mass, stiffness, shape)


@inlined
def _step(state: State, now: int, F: float) -> None:
    beam, lumped, mid = state.beam, state.extra, state.grid.mid
    if lumped.mass > 0.0:
        pull = F - lumped.stiffness * beam.w[now, mid]
        beam.du[mid] = state.grid.dt**2 / lumped.mass * pull
    beam.u[mid] += beam.du[mid]
    w_mid = beam.w[now, mid] + beam.u[mid]
    for i in range(2, mid + 1):
        beam.w[1 - now, i] = lumped.shape[i] * w_mid
    beam.w[1 - now, mid] = w_mid
    mirror(beam.w, now, beam.u, state.grid)


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    """Return kinetic (see beam.py) and elastic energy."""
    beam, lumped, mid = state.beam, state.extra, state.grid.mid
    u, w = beam.u[mid], beam.w[now, mid]
    moving = lumped.mass * u * (u - beam.du[mid]) / state.grid.dt**2
    return 0.5 * (moving + lumped.stiffness * w * w)


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    """Leave the force at mid-span: there is no other place."""
    return 0.0, 0.0


@compiled
def _settle(state: State) -> None:
    rest_beam(state.beam)


MODEL = BeamModel(
    _make, _step, EULER_BERNOULLI.curvature, _energy, deflected, _spread, settle=_settle
)
