"""Lumped masses: an eighth of each element's at each of its nodes."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import CORNERS, Floats
from impactlab.model.impact import Impact


def nodal_masses(mesh: Mesh, impact: Impact) -> Floats:
    """Mass of each node in kg, (n,).

    The sphere's density is scaled so that all four quarters weigh what the impact says.
    """
    volumes = element_volumes(mesh)
    ball = volumes[mesh.body == SPHERE].sum()
    density = np.where(
        mesh.body == BEAM,
        impact.beam.material.density,
        impact.sphere.total_mass / 4.0 / ball if ball > 0.0 else 0.0,
    )
    each = np.repeat(density * volumes / 8.0, 8)
    return np.asarray(
        np.bincount(mesh.elements.ravel(), weights=each, minlength=len(mesh.nodes)), dtype=float
    )


def element_volumes(mesh: Mesh) -> Floats:
    """Volume of each element in m3, (e,): Gauss's rule of two points a side is exact."""
    points, total = mesh.nodes[mesh.elements], np.zeros(len(mesh.elements))
    for place in CORNERS / np.sqrt(3.0):
        one = 1.0 + CORNERS * place
        slopes = [CORNERS[:, a] * np.prod(np.delete(one, a, axis=1), axis=1) for a in range(3)]
        total += np.linalg.det(0.125 * np.stack(slopes) @ points)
    return total
