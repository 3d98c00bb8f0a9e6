"""The mesh in a deck: nodes, elements, sets and surfaces, numbered from 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from impactlab.fem3d.deck import sets
from impactlab.fem3d.deck.case import Case
from impactlab.fem3d.deck.faces import Faces, lower_sphere, top_of_beam
from impactlab.fem3d.deck.lines import listed, number
from impactlab.fem3d.deck.units import LENGTH


def geometry(case: Case, kinds: Mapping[bool, str]) -> Iterator[str]:
    """kinds: names of the element types, fully integrated (True) and not."""
    yield "*NODE, NSET=ALL_NODES"
    for place, (x, y, z) in enumerate((LENGTH * case.mesh.nodes).tolist(), start=1):
        yield f"{place}, {number(x)}, {number(y)}, {number(z)}"
    groups = sets.element_groups(case.mesh)
    for name, (full, chosen) in groups.items():
        yield f"*ELEMENT, TYPE={kinds[full]}, ELSET={name}"
        numbers = np.flatnonzero(chosen)
        rows = np.column_stack([numbers, case.mesh.elements[numbers]]) + 1
        yield from (", ".join(map(str, row)) for row in rows.tolist())
    for body in sets.BODIES:
        yield f"*ELSET, ELSET={body}"
        yield from (name for name in groups if name.startswith(f"{body}_"))
    for name, members in sets.node_sets(case.impact, case.mesh).items():
        yield f"*NSET, NSET={name}"
        yield from listed(members + 1)
    yield from _surface(sets.SPHERE_SURFACE, lower_sphere(case.mesh))
    yield from _surface(sets.BEAM_SURFACE, top_of_beam(case.mesh))


def _surface(name: str, faces: Faces) -> Iterator[str]:
    yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
    yield from (f"{element + 1}, S{face}" for element, face in faces.tolist())
