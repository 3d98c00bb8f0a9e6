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
from impactlab.kernels.jit import compiled, vectorised
from impactlab.kernels.quadrature import upper_half
from impactlab.kernels.types import Array, Record

FAR = 1e300
"""A curvature that no section reaches (1/m)."""


class Section(NamedTuple):
    """The rule's fibres and their material, for one run.

    z: distance from the axis, m, outermost first; area: twice B times the rule's weight, m2;
    lever: E area z, N m; each of shape (P // 2,). stiffness: (EI)_q = sum(E area z^2), N m2, the
    rule's own. yield_curvature: where the outermost fibre first yields, 1/m. E, S_y, H_i, H_k: Pa.
    """

    z: Array
    area: Array
    lever: Array
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
        E * area * z,
        stiffness,
        case.beam_yield_stress / (E * z[0]),
        E,
        case.beam_yield_stress,
        case.beam_isotropic_hardening_modulus,
        case.beam_kinematic_hardening_modulus,
    )


@vectorised
def bend(
    z: Array,
    lever: Array,
    E: float,
    S_y: float,
    H_i: float,
    H_k: float,
    kappa: float,
    plastic_strain: Array,
    peeq: Array,
    i: int,
) -> tuple[float, float, float]:
    """Take the fibres of section i to curvature kappa.

    Updates row i of plastic_strain and peeq, shape (sections, P // 2). The first six arguments are
    the section's. Returns (M_0, kappa_min, kappa_max) of its new
    elastic interval. Runs at every yielding section and step, so it takes arrays, not a Section:
    handing that on would count references up and down.
    """
    M_0, kappa_min, kappa_max = 0.0, -FAR, FAR
    for j in range(z.size):
        strain, slipped = plastic_strain[i, j], peeq[i, j]
        strain, slipped = fibre.return_mapping(-z[j] * kappa, strain, slipped, E, S_y, H_i, H_k)
        plastic_strain[i, j], peeq[i, j] = strain, slipped
        M_0 -= lever[j] * strain
        least, largest = fibre.elastic_range(strain, slipped, E, S_y, H_i, H_k)
        kappa_min = max(kappa_min, -largest / z[j])
        kappa_max = min(kappa_max, -least / z[j])
    return M_0, kappa_min, kappa_max


@compiled
def plastic_energies(section: Section, plastic_strain: Array, peeq: Array) -> tuple[float, float]:
    """(stored at zero curvature, dissipated) energy per length of beam, J/m."""
    stored, dissipated = 0.0, 0.0
    for j in range(section.z.size):
        stored += section.area[j] * fibre.stored_energy(plastic_strain[j], section.E, section.H_k)
        dissipated += section.area[j] * fibre.dissipated_energy(peeq[j], section.S_y, section.H_i)
    return stored, dissipated
