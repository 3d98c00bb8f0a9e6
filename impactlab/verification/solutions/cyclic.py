"""Bending to and fro: stresses and moments after turns of the curvature.

A fibre with kinematic hardening is a spring beside a perfectly plastic fibre, whose stress is
clipped anew on every way; with isotropic hardening the elastic range reaches, on both sides, as far
as the stress ever did. No plastic strain is needed.
Sources: Masing (1926); Prandtl (1928) and Besseling (1958) for the elements side by side.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impactlab.model.beam import Beam
from impactlab.model.material import Material
from impactlab.verification.solutions import bending

Floats = NDArray[np.float64]


def fibre_stresses(material: Material, strains: ArrayLike) -> Floats:
    """Stress in Pa along a path of strains, shape (steps, ...), from the virgin fibre at zero.

    Between two steps the strain goes straight. With one kind of hardening, or none.

    Raises ValueError when the material has both kinds.
    """
    path = np.asarray(strains, dtype=np.float64)
    if not material.isotropic_hardening_modulus:
        return _kinematic(material, path)
    if material.kinematic_hardening_modulus:
        raise ValueError("cyclic: isotropic or kinematic hardening, not both")
    return _isotropic(material, path)


def rule_moments(
    beam: Beam, curvatures: ArrayLike, positions: ArrayLike, weights: ArrayLike
) -> Floats:
    """Moment in N m along a path of curvatures (1/m, shape (steps,)) that a rule gives.

    positions, weights: the rule's on [-1, 1], shape (points,). Sign of the curvature.

    Raises ValueError when the material has both kinds of hardening.
    """
    z = 0.5 * beam.depth * np.asarray(positions, dtype=np.float64)
    area = 0.5 * beam.depth * beam.width * np.asarray(weights, dtype=np.float64)
    stresses = fibre_stresses(beam.material, np.multiply.outer(np.asarray(curvatures), z))
    return np.asarray(stresses @ (area * z))


def moment_after_turn(beam: Beam, turn: float, curvature: ArrayLike) -> Floats:
    """Moment in N m at each `curvature` (1/m), bent to `turn` at first and then straight back.

    Masing's rule: M = M_t - 2 f((kappa_t - kappa)/2) of the first loading M = f(kappa), as far as
    -kappa_t. For no hardening, and for kinematic hardening.
    """
    back = 0.5 * (turn - np.asarray(curvature, dtype=np.float64))
    return np.asarray(bending.moment(beam, turn) - 2.0 * bending.moment(beam, back))


def _kinematic(material: Material, path: Floats) -> Floats:
    E, H = material.youngs_modulus, material.kinematic_hardening_modulus
    share = H / (E + H)
    clipped, stress = [], np.zeros(path.shape[1:])
    limit = (1.0 - share) * material.yield_stress
    for before, here in pairwise(np.concatenate([np.zeros_like(path[:1]), path])):
        stress = np.clip(stress + (1.0 - share) * E * (here - before), -limit, limit)
        clipped.append(stress)
    return np.asarray(share * E * path + np.array(clipped))


def _isotropic(material: Material, path: Floats) -> Floats:
    E, H = material.youngs_modulus, material.isotropic_hardening_modulus
    stresses, stress = [], np.zeros(path.shape[1:])
    farthest = np.full(path.shape[1:], material.yield_stress)
    for before, here in pairwise(np.concatenate([np.zeros_like(path[:1]), path])):
        elastic = stress + E * (here - before)
        beyond = np.maximum(np.abs(elastic) - farthest, 0.0)
        stress = elastic - np.sign(elastic) * beyond * E / (E + H)
        farthest = np.maximum(farthest, np.abs(stress))
        stresses.append(stress)
    return np.array(stresses)
