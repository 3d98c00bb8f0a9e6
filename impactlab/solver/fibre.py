"""One fibre: one-dimensional return mapping with linear hardening.

stress = E (strain - plastic_strain); yield: |stress - H_k plastic_strain| <= S_y + H_i peeq.
All moduli and stresses in Pa. Source: the standard closest-point return, exact for linear
hardening (Simo and Hughes, Computational Inelasticity, box 1.5).
"""

from __future__ import annotations

import math

from impactlab.solver.jit import compiled, vectorised


@vectorised
def return_mapping(
    strain: float, plastic_strain: float, peeq: float, E: float, S_y: float, H_i: float, H_k: float
) -> tuple[float, float]:
    """(plastic_strain, peeq) after the fibre has been taken to `strain`."""
    relative = E * (strain - plastic_strain) - H_k * plastic_strain
    excess = abs(relative) - (S_y + H_i * peeq)
    if excess > 0.0:
        slip = excess / (E + H_i + H_k)
        plastic_strain += math.copysign(slip, relative)
        peeq += slip
    return plastic_strain, peeq


@vectorised
def elastic_range(
    plastic_strain: float, peeq: float, E: float, S_y: float, H_i: float, H_k: float
) -> tuple[float, float]:
    """(least, largest) strain that the fibre can take without yielding."""
    centre = plastic_strain * (1.0 + H_k / E)
    radius = (S_y + H_i * peeq) / E
    return centre - radius, centre + radius


@compiled
def stored_energy(plastic_strain: float, E: float, H_k: float) -> float:
    """Energy density (J/m3) at zero total strain: residual stress and back stress."""
    return 0.5 * (E + H_k) * plastic_strain * plastic_strain


@compiled
def dissipated_energy(peeq: float, S_y: float, H_i: float) -> float:
    """Energy density (J/m3) dissipated: the integral of S_y + H_i peeq over peeq."""
    return (S_y + 0.5 * H_i * peeq) * peeq
