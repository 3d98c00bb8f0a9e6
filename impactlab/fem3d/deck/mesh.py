"""The mesh in a deck: nodes, elements, sets and surfaces, numbered from 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from impactlab.fem3d.deck.case import LENGTH, Case, listed, number
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Integers, Truths
from impactlab.model.impact import Impact

SPHERE_NODES = "SPHERE_NODES"
SYMMETRY_X, SYMMETRY_Y, SUPPORT = "SYMMETRY_X", "SYMMETRY_Y", "SUPPORT"
MIDSPAN, CENTRE, POLE, TOP = "MIDSPAN", "SPHERE_CENTRE", "SPHERE_POLE", "BEAM_TOP"
TRACKED = "TRACKED"
"""Name of the set of these four nodes together."""
BODIES = {"BEAM": BEAM, "SPHERE": SPHERE}
SPHERE_SURFACE, BEAM_SURFACE = "SPHERE_SURFACE", "BEAM_SURFACE"


def node_sets(impact: Impact, mesh: Mesh) -> dict[str, Integers]:
    """Return node numbers, from 0, by the name of the set."""
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
    """Return per group (one body, one kind) whether it is fully integrated, and its elements.

    Groups without elements are left out.
    """
    groups = {
        f"{name}_{'FINE' if full else 'COARSE'}": (full, (mesh.body == body) & (mesh.full == full))
        for name, body in BODIES.items()
        for full in (True, False)
    }
    return {name: (full, which) for name, (full, which) in groups.items() if which.any()}


_CORNERS = np.array(
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
)
"""An element's nodes on its faces S1 to S6."""
_NEAR = 1e-6
"""Distance from a plane at which a node is on it, over the size of an element."""

Faces = NDArray[np.int64]
"""(f, 2): element (from 0) and face (from 1)."""


def top_of_beam(mesh: Mesh) -> Faces:
    """Return all faces of the beam that face the sphere."""
    faces, nodes = _outer(mesh, BEAM)
    return np.asarray(faces[_on(mesh, nodes, 2)])


def lower_sphere(mesh: Mesh) -> Faces:
    """Return the faces of the sphere's surface below its centre."""
    faces, nodes = _outer(mesh, SPHERE)
    middle = mesh.nodes[nodes, 2].mean(axis=1)
    height = 0.5 * np.ptp(mesh.nodes[np.unique(nodes), 2])
    cut = _on(mesh, nodes, 0) | _on(mesh, nodes, 1)
    return np.asarray(faces[~cut & (middle < height)])


def _on(mesh: Mesh, nodes: Integers, axis: int) -> Truths:
    """Return which faces lie in the plane through the origin across `axis`."""
    return np.asarray(np.all(np.abs(mesh.nodes[nodes, axis]) < _NEAR * mesh.element_size, axis=1))


def _outer(mesh: Mesh, body: int) -> tuple[Faces, Integers]:
    """Return the faces that only one element of the body has, and their nodes, (f, 4)."""
    own = np.flatnonzero(mesh.body == body)
    nodes = mesh.elements[own][:, _CORNERS].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(nodes, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer = np.sort(first[count == 1])
    faces = np.stack([own[outer // 6], outer % 6 + 1], axis=1)
    return faces, nodes[outer]


def geometry(case: Case, kinds: Mapping[bool, str]) -> Iterator[str]:
    """Yield the mesh. kinds: element types, fully integrated (True) and not."""
    yield "*NODE, NSET=ALL_NODES"
    for place, (x, y, z) in enumerate((LENGTH * case.mesh.nodes).tolist(), start=1):
        yield f"{place}, {number(x)}, {number(y)}, {number(z)}"
    groups = element_groups(case.mesh)
    for name, (full, chosen) in groups.items():
        yield f"*ELEMENT, TYPE={kinds[full]}, ELSET={name}"
        numbers = np.flatnonzero(chosen)
        rows = np.column_stack([numbers, case.mesh.elements[numbers]]) + 1
        yield from (", ".join(map(str, row)) for row in rows.tolist())
    for body in BODIES:
        yield f"*ELSET, ELSET={body}"
        yield from (name for name in groups if name.startswith(f"{body}_"))
    for name, members in node_sets(case.impact, case.mesh).items():
        yield f"*NSET, NSET={name}"
        yield from listed(members + 1)
    yield from _surface(SPHERE_SURFACE, lower_sphere(case.mesh))
    yield from _surface(BEAM_SURFACE, top_of_beam(case.mesh))


def _surface(name: str, faces: Faces) -> Iterator[str]:
    yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
    yield from (f"{element + 1}, S{face}" for element, face in faces.tolist())
