"""The energy of the whole beam, at a full step once u has been moved on."""

from __future__ import annotations

import numpy as np

from impactlab.solver.beam import Beam, Grid
from impactlab.solver.fibre_plasticity import PlasticState
from impactlab.solver.jit import compiled, vectorised
from impactlab.solver.section import Section, dissipated_energy, stored_energy
from impactlab.solver.types import ONE, TWO, Array


@compiled
def kinetic_energy(beam: Beam, grid: Grid, now: int, u_mid: float) -> float:
    """Return the kinetic energy in J, from the product of velocities half a step before and after.

    With the elastic energy it is what leapfrog conserves exactly in a linear beam. u_mid (m): u at
    mid-span before.
    """
    total = _kinetic_sum(beam.w, now, beam.u, beam.plastic, grid, u_mid)
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@vectorised
def _kinetic_sum(w: Array, now: int, u: Array, plastic: Array, grid: Grid, u_mid: float) -> float:
    half = 0.0
    for i in range(np.uint64(2), np.uint64(grid.mid)):
        beside = w[now, i - ONE] + w[now, i + ONE]
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w[now, i]
        half += u[i] * (u[i] - plastic[i] + grid.stiffness * fourth)
    return 2.0 * half + u[grid.mid] * u_mid


@compiled
def bending_energy(
    beam: Beam, plastic_state: PlasticState, section: Section, grid: Grid, now: int
) -> float:
    """Return the energy stored in J above what plastic strains store at zero curvature.

    Within the elastic interval, EI kappa^2/2 - M_0 kappa per length.
    """
    return grid.dx * _bending_sum(beam.w, now, plastic_state.M_0, section.stiffness, grid)


@compiled
def plastic_energy(
    plastic_state: PlasticState, section: Section, grid: Grid
) -> tuple[float, float]:
    """Return (stored at zero curvature, dissipated) energy in J, of fibres that are up to date."""
    stored, dissipated = 0.0, 0.0
    for i in range(2, grid.mid + 1):
        if plastic_state.peeq[i, 0] > 0.0:  # the outermost fibre yields first
            kept, lost = plastic_energies(
                section, plastic_state.plastic_strain, plastic_state.peeq, i
            )
            times = 1.0 if i == grid.mid else 2.0
            stored += times * kept
            dissipated += times * lost
    return stored * grid.dx, dissipated * grid.dx


@vectorised
def _bending_sum(w: Array, now: int, M_0: Array, EI: float, grid: Grid) -> float:
    half, mid = 0.0, grid.mid
    for i in range(np.uint64(2), np.uint64(mid)):
        kappa = (w[now, i - ONE] - 2.0 * w[now, i] + w[now, i + ONE]) * grid.per_dx2
        half += kappa * (0.5 * EI * kappa - M_0[i])
    kappa = 2.0 * (w[now, mid - 1] - w[now, mid]) * grid.per_dx2
    return 2.0 * half + kappa * (0.5 * EI * kappa - M_0[mid])


@vectorised
def plastic_energies(
    section: Section, plastic_strain: Array, peeq: Array, i: int
) -> tuple[float, float]:
    """Return (stored at zero curvature, dissipated) energy per length of section i, J/m."""
    stored, dissipated, moduli = 0.0, 0.0, section.moduli
    for j in range(section.z.size):
        stored += section.area[j] * stored_energy(plastic_strain[i, j], moduli.E, moduli.H_k)
        lost = dissipated_energy(peeq[i, j], moduli.S_y, moduli.H_i)
        dissipated += section.area[j] * lost
    return stored, dissipated
