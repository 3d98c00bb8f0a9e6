"""The fibre section: from curvature to bending moment.

strain(z) = -z kappa, M = B * integral of z stress dz (N m). The section and its strains are
antisymmetric about the axis, so only the fibres with z > 0 are kept, each counted twice.
While no fibre yields, M = M_0 - EI kappa: a section remembers M_0 and the interval
[kappa_min, kappa_max] of curvature (1/m) in which that holds, and only leaving it costs a loop
over the fibres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.kernels import fibre
from impactlab.kernels.jit import compiled
from impactlab.kernels.quadrature import upper_half
from impactlab.kernels.types import Array, Record


class Section(NamedTuple):
    """The rule's fibres and their material, for one run.

    z: distance from the axis, m, shape (P // 2,), outermost first. area: twice B times the
    rule's weight, m2, shape (P // 2,). stiffness: (EI)_q = sum(E area z^2), N m2, the rule's own.
    yield_curvature: where the outermost fibre first yields, 1/m. E, S_y, H_i, H_k: Pa.
    """

    z: Array
    area: Array
    stiffness: float
    yield_curvature: float
    E: float
    S_y: float
    H_i: float
    H_k: float


@compiled
def make_section(case: Record) -> Section:
    """The section of a case."""
    half = case.points // 2
    z, area = np.empty(half), np.empty(half)
    upper_half(case.rule, case.points, z, area)
    E, stiffness = case.beam_youngs_modulus, 0.0
    for j in range(half):
        z[j] *= 0.5 * case.beam_depth
        area[j] *= case.beam_depth * case.beam_width
        stiffness += E * area[j] * z[j] * z[j]
    return Section(
        z,
        area,
        stiffness,
        case.beam_yield_stress / (E * z[0]),
        E,
        case.beam_yield_stress,
        case.beam_isotropic_hardening_modulus,
        case.beam_kinematic_hardening_modulus,
    )


@compiled
def bend(
    section: Section, kappa: float, plastic_strain: Array, peeq: Array
) -> tuple[float, float, float]:
    """Take the fibres to curvature kappa, updating plastic_strain and peeq, shape (P // 2,).

    Returns (M_0, kappa_min, kappa_max) of the section's new elastic interval.
    """
    E, S_y, H_i, H_k = section.E, section.S_y, section.H_i, section.H_k
    M_0, kappa_min, kappa_max = 0.0, -np.inf, np.inf
    for j in range(section.z.size):
        z = section.z[j]
        plastic_strain[j], peeq[j] = fibre.return_mapping(
            -z * kappa, plastic_strain[j], peeq[j], E, S_y, H_i, H_k
        )
        M_0 -= E * section.area[j] * z * plastic_strain[j]
        least, largest = fibre.elastic_range(plastic_strain[j], peeq[j], E, S_y, H_i, H_k)
        kappa_min = max(kappa_min, -largest / z)
        kappa_max = min(kappa_max, -least / z)
    return M_0, kappa_min, kappa_max


@compiled
def plastic_energies(section: Section, plastic_strain: Array, peeq: Array) -> tuple[float, float]:
    """(stored at zero curvature, dissipated) energy per length of beam, J/m."""
    stored, dissipated = 0.0, 0.0
    for j in range(section.z.size):
        stored += section.area[j] * fibre.stored_energy(plastic_strain[j], section.E, section.H_k)
        dissipated += section.area[j] * fibre.dissipated_energy(peeq[j], section.S_y, section.H_i)
    return stored, dissipated
