"""Names of the decks' sets and surfaces, and who is in them."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Integers, Truths
from impactlab.model.impact import Impact

SPHERE_NODES = "SPHERE_NODES"
SYMMETRY_X, SYMMETRY_Y, SUPPORT = "SYMMETRY_X", "SYMMETRY_Y", "SUPPORT"
MIDSPAN, CENTRE, POLE, TOP = "MIDSPAN", "SPHERE_CENTRE", "SPHERE_POLE", "BEAM_TOP"
TRACKED = "TRACKED"
"""The four of the line above together."""
BODIES = {"BEAM": BEAM, "SPHERE": SPHERE}
SPHERE_SURFACE, BEAM_SURFACE = "SPHERE_SURFACE", "BEAM_SURFACE"


def node_sets(impact: Impact, mesh: Mesh) -> dict[str, Integers]:
    """Node numbers from 0."""
    centre = np.array([0.0, 0.0, impact.sphere.radius])
    single = {
        MIDSPAN: mesh.axis_node,
        CENTRE: int(np.argmin(np.linalg.norm(mesh.nodes - centre, axis=1))),
        POLE: mesh.pole,
        TOP: mesh.top_node,
    }
    return {
        SPHERE_NODES: np.unique(mesh.elements[mesh.body == SPHERE]),
        SYMMETRY_X: mesh.symmetry_x,
        SYMMETRY_Y: mesh.symmetry_y,
        SUPPORT: mesh.support,
        **{name: np.array([node], np.int32) for name, node in single.items()},
        TRACKED: np.array(list(single.values()), np.int32),
    }


def element_groups(mesh: Mesh) -> dict[str, tuple[bool, Truths]]:
    """Elements of one body and one kind by the group's name: whether fully integrated, and which.

    Groups without elements are left out.
    """
    groups = {
        f"{name}_{'FINE' if full else 'COARSE'}": (full, (mesh.body == body) & (mesh.full == full))
        for name, body in BODIES.items()
        for full in (True, False)
    }
    return {name: (full, which) for name, (full, which) in groups.items() if which.any()}
