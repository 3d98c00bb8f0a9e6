"""Bending and static deflection of a beam of rectangular section, loaded once or to and fro.

Moments have the sign of the curvature here (docs/theory.md's M = B * integral of z sigma dz,
with strain -z kappa, has the opposite one). Loaded once, the material is elastic, then hardens
linearly with h, the sum of the isotropic and the kinematic modulus, which cannot be distinguished
as long as no fibre unloads.

To and fro, a fibre with kinematic hardening is a spring beside a perfectly plastic fibre, whose
stress is clipped anew on every way; with isotropic hardening the elastic range reaches, on both
sides, as far as the stress ever did. No plastic strain is needed.
Sources: any plasticity textbook, e.g. Lubliner, Plasticity Theory (1990), section 4.4; Masing
(1926); Prandtl (1928) and Besseling (1958) for the elements side by side.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from impactlab.model.bodies import Beam
from impactlab.model.material import Material
from impactlab.types import Floats


def yield_curvature(beam: Beam) -> float:
    """Return kappa_y = 2 sigma_y/(E H) in 1/m: the outermost fibre yields."""
    return 2.0 * beam.material.yield_stress / (beam.material.youngs_modulus * beam.depth)


def yield_moment(beam: Beam) -> float:
    """Return M_y in N m: the outermost fibre yields, sigma_y B H^2/6."""
    return float(beam.material.yield_stress / beam.section.stress_per_moment)


def plastic_moment(beam: Beam) -> float:
    """Return M_p in N m: every fibre yields, without hardening, sigma_y B H^2/4."""
    return float(beam.material.yield_stress * beam.section.plastic_modulus)


def collapse_load(beam: Beam) -> float:
    """Return the mid-span load in N under which the beam collapses, 4 M_p/L; no hardening."""
    return 4.0 * plastic_moment(beam) / beam.span


def static_deflection(beam: Beam, load: float) -> float:
    """Return the elastic mid-span deflection in m under a `load` (N) there: P L^3/(48 EI)."""
    return load * beam.span**3 / (48.0 * beam.bending_stiffness)


def moment(beam: Beam, curvature: ArrayLike) -> Floats:
    """Return the moment in N m at each `curvature` (1/m, any shape), by closed form.

    Without hardening M_p (1 - (kappa_y/kappa)^2/3) beyond yield. A hardening fibre is an elastic
    one and a perfectly plastic one side by side, and so is the section.
    """
    kappa = np.asarray(curvature, dtype=np.float64)
    beyond = np.maximum(np.abs(kappa) / yield_curvature(beam), 1.0)
    plastic = np.sign(kappa) * plastic_moment(beam) * (1.0 - 1.0 / (3.0 * beyond**2))
    elastic = beam.bending_stiffness * kappa
    perfect = np.where(beyond > 1.0, plastic, elastic)
    share = _elastic_share(beam.material)
    return np.asarray(share * elastic + (1.0 - share) * perfect)


def _elastic_share(material: Material) -> float:
    """Return the tangent modulus beyond yield over Young's modulus: h/(E + h)."""
    hardening = material.isotropic_hardening_modulus + material.kinematic_hardening_modulus
    return hardening / (material.youngs_modulus + hardening)


def path_stresses(material: Material, strains: ArrayLike) -> Floats:
    """Return the stress in Pa along a path of strains, shape (steps, ...), from the virgin fibre.

    Between two steps the strain goes straight. With one kind of hardening, or none.

    Raises ValueError when the material has both kinds.
    """
    path = np.asarray(strains, dtype=np.float64)
    isotropic = material.isotropic_hardening_modulus
    if isotropic and material.kinematic_hardening_modulus:
        raise ValueError("bending: isotropic or kinematic hardening, not both")
    E, share = material.youngs_modulus, _elastic_share(material)
    stresses, stress = [], np.zeros(path.shape[1:])
    limit = (1.0 - share) * material.yield_stress
    farthest = np.full(path.shape[1:], material.yield_stress)
    for before, strain in pairwise(np.concatenate([np.zeros_like(path[:1]), path])):
        if isotropic:
            elastic = stress + E * (strain - before)
            beyond = np.maximum(np.abs(elastic) - farthest, 0.0)
            stress = elastic - np.sign(elastic) * beyond * E / (E + isotropic)
            farthest = np.maximum(farthest, np.abs(stress))
        else:  # the perfectly plastic fibre beside the spring
            stress = np.clip(stress + (1.0 - share) * E * (strain - before), -limit, limit)
        stresses.append(stress)
    fibre = np.array(stresses)
    return fibre if isotropic else np.asarray(share * E * path + fibre)


def path_moments(beam: Beam, curvatures: Floats, positions: Floats, weights: Floats) -> Floats:
    """Return the moment in N m along a path of curvatures (1/m, shape (steps,)) that a rule gives.

    positions, weights: the rule's on [-1, 1], shape (points,). Sign of the curvature.
    """
    z, area = beam.section.fibres(positions, weights)
    stresses = path_stresses(beam.material, np.multiply.outer(curvatures, z))
    return np.asarray(stresses @ (area * z))


def moment_after_turn(beam: Beam, turn: float, curvature: ArrayLike) -> Floats:
    """Return the moment in N m at each `curvature` (1/m), bent to `turn`, then straight back.

    Masing's rule: M = M_t - 2 f((kappa_t - kappa)/2) of the first loading M = f(kappa), as far as
    -kappa_t. For no hardening, and for kinematic hardening.
    """
    back = 0.5 * (turn - np.asarray(curvature, dtype=np.float64))
    return np.asarray(moment(beam, turn) - 2.0 * moment(beam, back))
