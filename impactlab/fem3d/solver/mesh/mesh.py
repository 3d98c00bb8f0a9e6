"""The mesh of the quarter model: nodes, hexahedra, and the sets that are paired and held.

The mesh is cut along graded lines: fine at their beginning and coarser with the distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from impactlab.model.impact import Impact

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
        """Return the sphere's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 0])

    @property
    def top_node(self) -> int:
        """Return the beam's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 1])


def corner_volumes(nodes: Floats, elements: Integers) -> Floats:
    """Return the Jacobian determinant at each corner, (e, 8), in m3: 0 where flat."""
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


def nodal_masses(mesh: Mesh, impact: Impact) -> Floats:
    """Return the lumped mass of each node in kg, (n,): an eighth of each of its elements.

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
    """Return each element's volume in m3, (e,): Gauss's rule of two points per side is exact."""
    points, total = mesh.nodes[mesh.elements], np.zeros(len(mesh.elements))
    for place in CORNERS / np.sqrt(3.0):
        one = 1.0 + CORNERS * place
        slopes = [CORNERS[:, a] * np.prod(np.delete(one, a, axis=1), axis=1) for a in range(3)]
        total += np.linalg.det(0.125 * np.stack(slopes) @ points)
    return total


def uniform(size: float, length: float) -> int:
    """Return the number of intervals of at most `size` in `length` (both in m), at least 1."""
    return max(math.ceil(length / size * (1.0 - 1e-9)), 1)


def graded(size: float, fine: float, length: float, ratio: float, largest: float) -> Floats:
    """Return coordinates in m, from 0 to `length`: intervals of `size` up to `fine`, then growing.

    ratio: at most, of neighbouring intervals beyond `fine`, until they reach `largest`; it is
    lowered so that the last point falls on `length`. `fine` must be a multiple of `size`, or reach
    `length`, which is then cut into equal intervals.
    """
    if fine >= length * (1.0 - 1e-9):
        return np.linspace(0.0, length, uniform(size, length) + 1)
    start = size * np.arange(round(fine / size) + 1)
    points = np.concatenate([start, start[-1] + _grown(size, length - start[-1], ratio, largest)])
    points[-1] = length
    return points


def _grown(size: float, rest: float, ratio: float, largest: float) -> Floats:
    """Return the ends of intervals that fill `rest` (m), none much smaller than `size`."""
    count = 1
    while _intervals(size, count, ratio, largest).sum() < rest:
        count += 1
    if count * size >= rest:
        return np.linspace(0.0, rest, max(count - 1, 1) + 1)[1:]
    fits = brentq(
        lambda r: _intervals(size, count, r, largest).sum() - rest, 1.0, ratio, xtol=1e-14
    )
    return np.cumsum(_intervals(size, count, fits, largest))


def _intervals(size: float, count: int, ratio: float, largest: float) -> Floats:
    return np.asarray(np.minimum(size * ratio ** np.arange(1.0, count + 1), max(largest, size)))


def brick(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Integers]:
    """Return nodes (n, 3) in m and elements (e, 8) of a brick cut at ascending x, y and z.

    Nodes are numbered with z fastest, x slowest: (i ny + j) nz + k.
    """
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(nodes.shape[0], dtype=np.int32).reshape(x.size, y.size, z.size)
    return nodes, cells(number)


def cells(number: Integers) -> Integers:
    """Return the hexahedra, (e, 8) in VTK's order, of a lattice of node numbers (i, j, k)."""
    low, high = slice(None, -1), slice(1, None)
    ring = ((low, low), (high, low), (high, high), (low, high))
    corners = [number[(*place, level)] for level in (low, high) for place in ring]
    return np.stack(corners, axis=-1).reshape(-1, 8)
