"""What the quarter model's mesh is: nodes, hexahedra, and who touches and holds whom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]
Truths = NDArray[np.bool_]

BEAM, SPHERE = 0, 1
"""Values of Mesh.body."""

_RING = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
CORNERS = np.array([(*place, level) for level in (-1.0, 1.0) for place in _RING])
"""Natural coordinates of a hexahedron's nodes, (8, 3), in VTK's order."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A quarter of beam and sphere: x along the beam, y across, z upwards, in m.

    x = 0 is mid-span, y = 0 mid-width (both planes of symmetry), z = 0 the beam's top, which the
    sphere touches at the origin.

    nodes: (n, 3). elements: (e, 8) node numbers in VTK's order of a hexahedron. body: (e,), BEAM or
    SPHERE. full: (e,), whether fully integrated. pairs: (p, 2) nodes (of the sphere, of the beam)
    with the same x and y. gaps: (p,) initial distances in m. rim: (p,), pairs on the border of the
    matched patch. symmetry_x, symmetry_y: nodes that keep their x (y). support: nodes that keep
    their z. axis_node: on the beam's axis at mid-span. element_size: of the patch, in m.
    patch: half the side of the square of matched nodes, in m.

    Raises ValueError when an element is inverted or has no volume at a corner.
    """

    nodes: Floats
    elements: Integers
    body: Integers
    full: Truths
    pairs: Integers
    gaps: Floats
    rim: Truths
    symmetry_x: Integers
    symmetry_y: Integers
    support: Integers
    axis_node: int
    element_size: float
    patch: float

    def __post_init__(self) -> None:
        corners = corner_volumes(self.nodes, self.elements)
        if np.any(wrong := np.min(corners, axis=1) <= 0.0):
            first = int(np.flatnonzero(wrong)[0])
            where = self.nodes[self.elements[first]].mean(axis=0)
            raise ValueError(
                f"mesh: {wrong.sum()} elements are inverted, the first at x, y, z = {where} m: "
                "take a smaller element_size"
            )

    @property
    def pole(self) -> int:
        """The sphere's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 0])

    @property
    def top_node(self) -> int:
        """The beam's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 1])


def corner_volumes(nodes: Floats, elements: Integers) -> Floats:
    """The Jacobian's determinant at each corner of each element, (e, 8), in m3: 0 where flat."""
    points = nodes[elements]
    result = np.empty(elements.shape)
    for corner, place in enumerate(CORNERS):
        edges = []
        for axis in range(3):
            along = np.delete(CORNERS - place, axis, axis=1)
            (other,) = [n for n in np.flatnonzero(~along.any(axis=1)) if n != corner]
            edges.append(0.5 * (points[:, other] - points[:, corner]) * -place[axis])
        result[:, corner] = np.linalg.det(np.stack(edges, axis=1))
    return result
