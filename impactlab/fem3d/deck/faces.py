"""Outer faces of the mesh, as both programs number them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Integers, Truths

_CORNERS = np.array(
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
)
"""An element's nodes on its faces S1 to S6."""
_NEAR = 1e-6
"""Distance from a plane at which a node is on it, over the size of an element."""

Faces = NDArray[np.int64]
"""(f, 2): element (from 0) and face (from 1)."""


def top_of_beam(mesh: Mesh) -> Faces:
    """All faces of the beam that look to the sphere."""
    faces, nodes = _outer(mesh, BEAM)
    return np.asarray(faces[_on(mesh, nodes, 2)])


def lower_sphere(mesh: Mesh) -> Faces:
    """The faces of the sphere's surface below its centre."""
    faces, nodes = _outer(mesh, SPHERE)
    middle = mesh.nodes[nodes, 2].mean(axis=1)
    height = 0.5 * np.ptp(mesh.nodes[np.unique(nodes), 2])
    cut = _on(mesh, nodes, 0) | _on(mesh, nodes, 1)
    return np.asarray(faces[~cut & (middle < height)])


def _on(mesh: Mesh, nodes: Integers, axis: int) -> Truths:
    """Whether a face lies in the plane through the origin across `axis`."""
    return np.asarray(np.all(np.abs(mesh.nodes[nodes, axis]) < _NEAR * mesh.element_size, axis=1))


def _outer(mesh: Mesh, body: int) -> tuple[Faces, Integers]:
    """Faces that one element of the body alone has, and their nodes, (f, 4)."""
    own = np.flatnonzero(mesh.body == body)
    nodes = mesh.elements[own][:, _CORNERS].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(nodes, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer = np.sort(first[count == 1])
    faces = np.stack([own[outer // 6], outer % 6 + 1], axis=1)
    return faces, nodes[outer]
