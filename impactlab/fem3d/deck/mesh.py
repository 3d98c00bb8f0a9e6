"""The mesh in a deck: nodes, elements, sets and surfaces, numbered from 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Integers, Truths

LENGTH = 1e3
"""mm per m."""
_BODIES = {"BEAM": BEAM, "SPHERE": SPHERE}


def element_groups(mesh: Mesh) -> dict[str, tuple[bool, Truths]]:
    """Return per group (one body, one kind) whether it is fully integrated, and its elements.

    Groups without elements are left out.
    """
    groups = {
        f"{name}_{'FINE' if full else 'COARSE'}": (full, (mesh.body == body) & (mesh.full == full))
        for name, body in _BODIES.items()
        for full in (True, False)
    }
    return {name: (full, which) for name, (full, which) in groups.items() if which.any()}


_CORNERS = np.array(
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
)
"""An element's nodes on its faces S1 to S6."""
_PER_LINE = 16
"""Entries that a data line may hold in both programs."""
_NEAR = 1e-6
"""Distance from a plane at which a node is on it, over the size of an element."""


def _on(mesh: Mesh, nodes: Integers, axis: int) -> Truths:
    """Return which faces lie in the plane through the origin across `axis`."""
    return np.asarray(np.all(np.abs(mesh.nodes[nodes, axis]) < _NEAR * mesh.element_size, axis=1))


def _outer(mesh: Mesh, body: int) -> tuple[Integers, Integers]:
    """Return the faces that only one element of the body has, and their nodes, (f, 4).

    Faces are (f, 2): element (from 0) and face (from 1).
    """
    own = np.flatnonzero(mesh.body == body)
    nodes = mesh.elements[own][:, _CORNERS].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(nodes, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer = np.sort(first[count == 1])
    faces = np.stack([own[outer // 6], outer % 6 + 1], axis=1)
    return faces, nodes[outer]


def geometry(mesh: Mesh, radius: float, kinds: Mapping[bool, str]) -> Iterator[str]:
    """Yield the mesh. radius: of the sphere in m. kinds: of elements, full integration or not."""
    yield "*NODE, NSET=ALL_NODES"
    for place, (x, y, z) in enumerate((LENGTH * mesh.nodes).tolist(), start=1):
        # 19 characters at most, of the 20 that CalculiX reads, with 13 digits.
        yield f"{place}, {x:.12e}, {y:.12e}, {z:.12e}"
    groups = element_groups(mesh)
    for name, (full, chosen) in groups.items():
        yield f"*ELEMENT, TYPE={kinds[full]}, ELSET={name}"
        numbers = np.flatnonzero(chosen)
        rows = np.column_stack([numbers, mesh.elements[numbers]]) + 1
        yield from (", ".join(map(str, row)) for row in rows.tolist())
    for body in _BODIES:
        yield f"*ELSET, ELSET={body}"
        yield from (name for name in groups if name.startswith(f"{body}_"))
    centre = np.linalg.norm(mesh.nodes - np.array([0.0, 0.0, radius]), axis=1).argmin()
    tracked = {
        "MIDSPAN": mesh.axis_node,
        "SPHERE_CENTRE": int(centre),
        "SPHERE_POLE": mesh.pole,
        "BEAM_TOP": mesh.top_node,
    }
    sets: dict[str, list[int]] = {
        "SPHERE_NODES": np.unique(mesh.elements[mesh.body == SPHERE]).tolist(),
        "SYMMETRY_X": mesh.symmetry_x.tolist(),
        "SYMMETRY_Y": mesh.symmetry_y.tolist(),
        "SUPPORT": mesh.support.tolist(),
        **{name: [node] for name, node in tracked.items()},
        "TRACKED": list(tracked.values()),
    }
    for name, members in sets.items():
        yield f"*NSET, NSET={name}"
        for at in range(0, len(members), _PER_LINE):
            yield ", ".join(str(node + 1) for node in members[at : at + _PER_LINE])
    # The sphere's surface below its centre, and the beam's top.
    ball, corners = _outer(mesh, SPHERE)
    middle = mesh.nodes[corners, 2].mean(axis=1)
    height = 0.5 * np.ptp(mesh.nodes[np.unique(corners), 2])
    cut = _on(mesh, corners, 0) | _on(mesh, corners, 1)
    beam, above = _outer(mesh, BEAM)
    surfaces = {
        "SPHERE_SURFACE": ball[~cut & (middle < height)],
        "BEAM_SURFACE": beam[_on(mesh, above, 2)],
    }
    for name, faces in surfaces.items():
        yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
        yield from (f"{element + 1}, S{face}" for element, face in faces.tolist())
