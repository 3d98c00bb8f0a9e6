"""Fibres of a section that bends and stretches: they yield under both strains together."""

from __future__ import annotations

from impactlab.solver.jit import compiled
from impactlab.solver.section import (
    FAR,
    FibreSection,
    elastic_range,
    flow_at_rate,
    return_mapping,
)
from impactlab.solver.strain_rate import RateLaw
from impactlab.solver.types import Array, Index


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
