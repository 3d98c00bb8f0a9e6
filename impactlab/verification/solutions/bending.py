"""Pure bending and static deflection of a beam of rectangular section, loaded monotonically.

Moments have the sign of the curvature here (physics.md's M = B * integral of z sigma dz, with
strain -z kappa, has the opposite one). Material: elastic, then linear hardening with h, the sum of
the isotropic and the kinematic modulus, which cannot be told apart as long as nothing unloads.
Source: any plasticity textbook, e.g. Lubliner, Plasticity Theory (1990), section 4.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impactlab.model.beam import Beam
from impactlab.model.checks import not_negative
from impactlab.model.material import Material

Floats = NDArray[np.float64]


def yield_curvature(beam: Beam) -> float:
    """kappa_y = 2 sigma_y/(E H) in 1/m: the outermost fibre yields."""
    return 2.0 * beam.material.yield_stress / (beam.material.youngs_modulus * beam.depth)


def yield_moment(beam: Beam) -> float:
    """M_y = sigma_y B H^2/6 in N m."""
    return beam.material.yield_stress * beam.width * beam.depth**2 / 6.0


def plastic_moment(beam: Beam) -> float:
    """M_p = sigma_y B H^2/4 in N m: every fibre yields, without hardening."""
    return beam.material.yield_stress * beam.width * beam.depth**2 / 4.0


def collapse_load(beam: Beam) -> float:
    """Static load at mid-span in N under which the beam collapses: 4 M_p/L, without hardening."""
    return 4.0 * plastic_moment(beam) / beam.span


def static_deflection(beam: Beam, load: float) -> float:
    """Elastic mid-span deflection in m under a `load` (N) there: P L^3/(48 EI).

    Raises ValueError when the load is negative or not finite.
    """
    return not_negative("bending", "load", load) * beam.span**3 / (48.0 * beam.bending_stiffness)


def moment(beam: Beam, curvature: ArrayLike) -> Floats:
    """Moment in N m at each `curvature` (1/m, any shape), by closed form.

    Without hardening M_p (1 - (kappa_y/kappa)^2/3) beyond yield. A hardening fibre is an elastic
    one and a perfectly plastic one side by side, and so is the section.

    Raises ValueError when a curvature is not finite.
    """
    kappa = _finite("curvature", curvature)
    beyond = np.maximum(np.abs(kappa) / yield_curvature(beam), 1.0)
    plastic = np.sign(kappa) * plastic_moment(beam) * (1.0 - 1.0 / (3.0 * beyond**2))
    elastic = beam.bending_stiffness * kappa
    perfect = np.where(beyond > 1.0, plastic, elastic)
    share = _elastic_share(beam.material)
    return np.asarray(share * elastic + (1.0 - share) * perfect)


def rule_moment(
    beam: Beam, curvature: ArrayLike, positions: ArrayLike, weights: ArrayLike
) -> Floats:
    """Moment in N m at each `curvature` (1/m, any shape) that an integration rule gives.

    positions, weights: the rule's points on [-1, 1] over the depth, shape (points,); the weights
    of a consistent rule add up to 2.

    Raises ValueError when a value is not finite, or positions and weights differ in shape.
    """
    kappa = _finite("curvature", curvature)
    xi, w = _finite("positions", positions), _finite("weights", weights)
    if xi.ndim != 1 or xi.shape != w.shape:
        raise ValueError(
            f"positions {xi.shape} and weights {w.shape}: must be one list each, alike"
        )
    z = 0.5 * beam.depth * xi
    sigma = fibre_stress(beam.material, kappa[..., np.newaxis] * z)
    return np.asarray(beam.width * 0.5 * beam.depth * (sigma * z) @ w)


def fibre_stress(material: Material, strain: ArrayLike) -> Floats:
    """Stress in Pa at each monotonically reached `strain` (any shape).

    Raises ValueError when a strain is not finite.
    """
    elastic = material.youngs_modulus * _finite("strain", strain)
    perfect = np.clip(elastic, -material.yield_stress, material.yield_stress)
    share = _elastic_share(material)
    return np.asarray(share * elastic + (1.0 - share) * perfect)


def _elastic_share(material: Material) -> float:
    """Tangent modulus beyond yield over Young's modulus: h/(E + h)."""
    hardening = material.isotropic_hardening_modulus + material.kinematic_hardening_modulus
    return hardening / (material.youngs_modulus + hardening)


def _finite(name: str, values: ArrayLike) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: every value must be a finite number")
    return array
