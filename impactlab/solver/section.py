"""The fibre section: from curvature to bending moment.

strain(z) = -z kappa, M = sum over the fibres of area z stress (N m). The strains are antisymmetric
about the axis, so only the fibres with z > 0 are kept, each counted twice.
While no fibre yields, M = M_0 - EI kappa: a section remembers M_0 and the interval
[kappa_min, kappa_max] of curvature (1/m) in which that holds, and only leaving it costs a loop
over the fibres.

A fibre is mapped back to the yield surface, with linear hardening, in one dimension:
stress = E (strain - plastic_strain); yield: |stress - H_k plastic_strain| <= S_y + H_i peeq.
All moduli and stresses in Pa. Source: the standard closest-point return, exact for linear
hardening (Simo and Hughes, Computational Inelasticity, box 1.5). Where the section stretches, too,
fibres yield under both strains together.
"""

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver.jit import allocating, compiled, summing
from impactlab.solver.strain_rate import RateLaw, overstress, rate_law
from impactlab.solver.types import ELASTIC, Array, Index, Record

FAR = 1e300
"""A curvature that no section reaches (1/m)."""

_ROUND_OFF = 1e-12
"""A fibre so near its yield strain, in shares of it, yields."""


class Moduli(NamedTuple):
    """Young's modulus, yield stress, isotropic and kinematic hardening modulus (Pa)."""

    E: float
    S_y: float
    H_i: float
    H_k: float


class FibreSection(NamedTuple):
    """The rule's fibres and their material, for one run.

    z: distance from the axis, m, outermost first; area: twice the fibre's, m2, for its mirror image
    (both by model/section.py); lever: E area z, N m; each of shape (P // 2,). stiffness: (EI)_q =
    sum(E area z^2), N m2, the rule's own. yield_curvature: where the outermost fibre first yields,
    1/m. rate: see strain_rate.py; None in the kernels without it. strain_ratio: real strains of a
    fibre over those here (model/section.py), (P // 2,).
    """

    z: Array
    area: Array
    lever: Array
    stiffness: float
    yield_curvature: float
    moduli: Moduli
    rate: RateLaw | None
    strain_ratio: Array


class Room(NamedTuple):
    """Room for the section of a run: z, area, lever and strain_ratio, see FibreSection."""

    z: Array
    area: Array
    lever: Array
    strain_ratio: Array


@allocating
def make_room(case: Record) -> Room:
    """Return room for the section of a case."""
    half = case.points // 2
    return Room(np.empty(half), np.empty(half), np.empty(half), np.empty(half))


@allocating
def make_section(case: Record, fibres: Array) -> FibreSection:
    """Return the section of a case; fibres: its row of model.section.fibre_table."""
    return cut_section(case, fibres, make_room(case))


@allocating
def cut_section(case: Record, fibres: Array, room: Room) -> FibreSection:
    """Return the section of a case in a room; fibres: see make_section."""
    E, stiffness, (z, area, lever, strain_ratio) = case.beam_youngs_modulus, 0.0, room
    for j in range(z.size):
        z[j], area[j], strain_ratio[j] = fibres[0, j], fibres[1, j], fibres[2, j]
        lever[j] = E * area[j] * z[j]
        stiffness += E * area[j] * z[j] * z[j]
    return FibreSection(
        z,
        area,
        lever,
        stiffness,
        FAR if case.beam_model == ELASTIC else case.beam_yield_stress / (E * z[0]),
        _moduli(case),
        None,
        strain_ratio,
    )


@compiled
def _moduli(case: Record) -> Moduli:
    return Moduli(
        case.beam_youngs_modulus,
        case.beam_yield_stress,
        case.beam_isotropic_hardening_modulus,
        case.beam_kinematic_hardening_modulus,
    )


@compiled
def fibre_rate(case: Record) -> RateLaw:
    """Return the law of the strain rate of a case's fibres."""
    return rate_law(case)


@allocating
def make_whole_room(case: Record) -> Room:
    """Return room for all fibres of the section of a case."""
    P = case.points
    return Room(np.empty(P), np.empty(P), np.empty(P), np.ones(P))


@allocating
def cut_whole_section(case: Record, fibres: Array, room: Room) -> FibreSection:
    """Return the section of a case with the fibres below the axis, too; see cut_section.

    None counts twice. A fibre on the axis has the area that the others leave of the section.
    """
    E, stiffness, (z, area, lever, ratio) = case.beam_youngs_modulus, 0.0, room
    points, half = z.size, z.size // 2
    rest = case.mass_per_length / case.beam_density
    for j in range(half):
        mirrored = points - 1 - j
        z[j], area[j] = fibres[0, j], 0.5 * fibres[1, j]
        z[mirrored], area[mirrored] = -z[j], area[j]
        rest -= fibres[1, j]
        stiffness += E * fibres[1, j] * z[j] * z[j]
    if points > 2 * half:
        z[half], area[half] = 0.0, max(rest, 0.0)
    for j in range(points):
        lever[j] = E * area[j] * z[j]
    yields = case.beam_yield_stress / (E * z[0])
    return FibreSection(z, area, lever, stiffness, yields, _moduli(case), fibre_rate(case), ratio)


@allocating
def with_rate(section: FibreSection, case: Record) -> FibreSection:
    """Return the section with the case's law of the strain rate."""
    return FibreSection(
        section.z,
        section.area,
        section.lever,
        section.stiffness,
        section.yield_curvature,
        section.moduli,
        fibre_rate(case),
        section.strain_ratio,
    )


@summing
def return_mapping(
    strain: float, plastic_strain: float, peeq: float, E: float, S_y: float, H_i: float, H_k: float
) -> tuple[float, float]:
    """Return (plastic_strain, peeq) after the fibre has been taken to `strain`."""
    relative = E * (strain - plastic_strain) - H_k * plastic_strain
    excess = abs(relative) - (S_y + H_i * peeq)
    if excess > 0.0:
        slip = excess / (E + H_i + H_k)
        plastic_strain += math.copysign(slip, relative)
        peeq += slip
    return plastic_strain, peeq


@summing
def elastic_range(
    plastic_strain: float, peeq: float, E: float, S_y: float, H_i: float, H_k: float
) -> tuple[float, float]:
    """Return the (least, largest) strain that the fibre can take without yielding."""
    centre = plastic_strain * (1.0 + H_k / E)
    radius = (S_y + H_i * peeq) / E
    return centre - radius, centre + radius


@compiled
def stored_energy(plastic_strain: float, E: float, H_k: float) -> float:
    """Return the energy density (J/m3) at zero total strain: residual stress and back stress."""
    return 0.5 * (E + H_k) * plastic_strain * plastic_strain


@compiled
def dissipated_energy(peeq: float, S_y: float, H_i: float) -> float:
    """Return the energy density (J/m3) dissipated: the integral of S_y + H_i peeq over peeq."""
    return (S_y + 0.5 * H_i * peeq) * peeq


@summing
def bend(
    section: FibreSection, kappa: float, plastic_strain: Array, peeq: Array, i: int
) -> tuple[float, float, float]:
    """Take the fibres of section i to curvature kappa (1/m).

    Updates row i of plastic_strain and peeq, shape (sections, P // 2). Returns (M_0, kappa_min,
    kappa_max) of the new elastic interval.
    """
    z, lever = section.z, section.lever
    E, S_y, H_i, H_k = section.moduli
    M_0, kappa_min, kappa_max = 0.0, -FAR, FAR
    for j in range(z.size):
        strain, slipped = plastic_strain[i, j], peeq[i, j]
        strain, slipped = return_mapping(-z[j] * kappa, strain, slipped, E, S_y, H_i, H_k)
        plastic_strain[i, j], peeq[i, j] = strain, slipped
        M_0 -= lever[j] * strain
        least, largest = elastic_range(strain, slipped, E, S_y, H_i, H_k)
        kappa_min = max(kappa_min, -largest / z[j])
        kappa_max = min(kappa_max, -least / z[j])
    return M_0, kappa_min, kappa_max


@compiled
def flow_at_rate(
    moduli: Moduli,
    rate: RateLaw,
    trial: float,
    growth: float,
    plastic_strain: float,
    peeq: float,
    dt: float,
) -> tuple[float, float, float]:
    """Let a fibre flow for the time dt (s).

    trial (Pa): its stress over the back stress, were it elastic in that time; growth (Pa): the part
    of this time. Returns plastic_strain, peeq and the work of the overstress (J/m3).
    """
    E, S_y, H_i, H_k = moduli
    Y = S_y + H_i * peeq
    if abs(trial) <= Y * (1.0 + _ROUND_OFF):
        return plastic_strain, peeq, 0.0
    s, slip = overstress(abs(trial), Y, H_i, E + H_k, dt, rate)
    over = max(abs(trial - growth) - Y, 0.0)
    work = 0.5 * (over + s * (Y + H_i * slip)) * slip
    return plastic_strain + math.copysign(slip, trial), peeq + slip, work


@compiled
def bend_at_rate(
    section: FibreSection,
    rate: RateLaw,
    kappa: float,
    before: float,
    dt: float,
    plastic_strain: Array,
    peeq: Array,
    i: int,
) -> tuple[float, float, float, float]:
    """Take the fibres of section i from the curvature `before` to kappa (1/m) in the time dt (s).

    Returns as `bend`, and the work of the overstress (J/m). The new elastic interval is the static
    one, which does not hold kappa as long as the section flows.
    """
    z, lever = section.z, section.lever
    E, S_y, H_i, H_k = section.moduli
    M_0, kappa_min, kappa_max, work = 0.0, -FAR, FAR, 0.0
    for j in range(z.size):
        strain, slipped = plastic_strain[i, j], peeq[i, j]
        trial, growth = -E * z[j] * kappa - (E + H_k) * strain, -E * z[j] * (kappa - before)
        strain, slipped, lost = flow_at_rate(
            section.moduli, rate, trial, growth, strain, slipped, dt
        )
        work += lost * section.area[j]
        plastic_strain[i, j], peeq[i, j] = strain, slipped
        M_0 -= lever[j] * strain
        least, largest = elastic_range(strain, slipped, E, S_y, H_i, H_k)
        kappa_min = max(kappa_min, -largest / z[j])
        kappa_max = min(kappa_max, -least / z[j])
    return M_0, kappa_min, kappa_max, work


@compiled
def tangent(
    section: FibreSection,
    kappa: float,
    direction: float,
    plastic_strain: Array,
    peeq: Array,
    i: int,
) -> tuple[float, float]:
    """Return (growth of M_0 with kappa in N m2, curvature in 1/m at which a further fibre yields).

    Of section i, which `bend` has taken to kappa, when it is bent on towards greater (direction 1)
    or smaller (-1) curvature.
    """
    z, (E, S_y, H_i, H_k) = section.z, section.moduli
    growth, limit = 0.0, direction * FAR
    for j in range(z.size):
        least, largest = elastic_range(plastic_strain[i, j], peeq[i, j], E, S_y, H_i, H_k)
        end = -(least if direction > 0.0 else largest) / z[j]
        if direction * (end - kappa) <= _ROUND_OFF * S_y / (E * z[j]):
            growth += section.lever[j] * z[j] * E / (E + H_i + H_k)
        elif direction * (limit - end) > 0.0:
            limit = end
    return growth, limit


@compiled
def strain_fibres(
    section: FibreSection,
    rate: RateLaw | None,
    e: float,
    kappa: float,
    before: tuple[float, float],
    dt: float,
    plastic_strain: Array,
    peeq: Array,
    i: Index,
) -> tuple[float, float, float, float]:
    """Take the fibres of section i to the strain e of the axis and the curvature kappa (1/m).

    Updates row i of plastic_strain and peeq, shape (sections, P). before: e and kappa at the
    last look, where fibres flow by the rate a time dt (s) ago. Returns (N_0 in N, M_0 in N m, the
    strain that no fibre yields by, work of the overstress in J/m).
    """
    z, (E, S_y, H_i, H_k) = section.z, section.moduli
    N_0, M_0, room, work = 0.0, 0.0, FAR, 0.0
    for j in range(z.size):
        strain, slipped, now = plastic_strain[i, j], peeq[i, j], e - z[j] * kappa
        if rate is not None and rate.D > 0.0:
            trial, growth = E * now - (E + H_k) * strain, E * (now - before[0] + z[j] * before[1])
            strain, slipped, lost = flow_at_rate(
                section.moduli, rate, trial, growth, strain, slipped, dt
            )
            work += lost * section.area[j]
        else:
            strain, slipped = return_mapping(now, strain, slipped, E, S_y, H_i, H_k)
        plastic_strain[i, j], peeq[i, j] = strain, slipped
        N_0 -= E * section.area[j] * strain
        M_0 -= section.lever[j] * strain
        least, largest = elastic_range(strain, slipped, E, S_y, H_i, H_k)
        room = min(room, largest - now, now - least)
    return N_0, M_0, room, work
