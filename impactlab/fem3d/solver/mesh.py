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
NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners that share an edge with each corner, turning right-handed."""


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
        points = self.nodes[self.elements]
        edges = points[:, NEIGHBOURS] - points[:, :, None]
        if np.any(wrong := np.linalg.det(edges).min(axis=1) <= 0.0):
            first = int(np.flatnonzero(wrong)[0])
            where = self.nodes[self.elements[first]].mean(axis=0)
            raise ValueError(
                f"mesh: {wrong.sum()} elements are inverted, the first at x, y, z = {where} m: "
                "take a smaller element_size"
            )

    def groups(self) -> list[tuple[int, bool, Integers]]:
        """Return the groups of elements alike in body and full: both, and the numbers in each."""
        return [
            (body, full, np.flatnonzero(chosen).astype(np.int32))
            for body in (BEAM, SPHERE)
            for full in (True, False)
            if np.any(chosen := (self.body == body) & (self.full == full))
        ]

    @property
    def pole(self) -> int:
        """Return the sphere's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 0])

    @property
    def top_node(self) -> int:
        """Return the beam's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 1])


def nodal_masses(mesh: Mesh, impact: Impact) -> Floats:
    """Return the lumped mass of each node in kg, (n,): an eighth of each of its elements.

    The sphere's density is that of sphere_density.
    """
    beam, sphere = impact.beam.material.density, sphere_density(mesh, impact)
    each = np.repeat(np.where(mesh.body == BEAM, beam, sphere) * element_volumes(mesh) / 8.0, 8)
    return np.asarray(
        np.bincount(mesh.elements.ravel(), weights=each, minlength=len(mesh.nodes)), dtype=float
    )


def sphere_density(mesh: Mesh, impact: Impact) -> float:
    """Return the density in kg/m3 with which all four quarters weigh what the impact says."""
    quarter = element_volumes(mesh)[mesh.body == SPHERE].sum()
    return float(impact.sphere.total_mass / 4.0 / quarter)


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

    def intervals(ratio: float) -> Floats:
        return np.asarray(np.minimum(size * ratio ** np.arange(1.0, count + 1), max(largest, size)))

    start = size * np.arange(round(fine / size) + 1)
    rest, count = length - start[-1], 1
    while intervals(ratio).sum() < rest:
        count += 1
    if count * size >= rest:  # none much smaller than `size`
        ends = np.linspace(0.0, rest, max(count - 1, 1) + 1)[1:]
    else:
        fits = brentq(lambda ratio: intervals(ratio).sum() - rest, 1.0, ratio, xtol=1e-14)
        ends = np.cumsum(intervals(fits))
    points = np.concatenate([start, start[-1] + ends])
    points[-1] = length
    return points


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
