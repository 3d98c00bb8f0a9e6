"""The mesh of an impact: a quarter of the beam and one of the sphere, matched where they touch.

The beam is cut along graded lines: fine at their beginning and coarser with the distance. The
sphere is a core of hexahedra with shells around it, out to the surface. The core is a lattice
(i, j, k) with i and j from 0 to `sides` and k from -height to height; each of its boundary nodes
sends a line out to the sphere's surface, cut by the layers. Surface nodes near the pole have the x
and y of the beam's; from there the lines flare out into an evenly cut core.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from impactlab.fem3d.solver.estimates import checked_patch, checked_size, uniform
from impactlab.fem3d.solver.impulses import bulges
from impactlab.model.bodies import RESISTANCES
from impactlab.model.checks import positive
from impactlab.model.impact import HINGES, MID_SPAN, Impact
from impactlab.types import Floats

Integers = NDArray[np.int32]

BEAM, SPHERE = 0, 1  # values of Mesh.body

_RING = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
CORNERS = np.array([(*place, level) for level in (-1.0, 1.0) for place in _RING])
"""Natural coordinates of a hexahedron's nodes, (8, 3), in VTK's order."""
FACES = np.array(
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
"""A hexahedron's nodes around each face, in the order of Abaqus' and CalculiX's S1 to S6."""
_FLAT = 1e-6  # distance from a plane, over the element size, that counts as zero
NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners that share an edge with each corner, turning right-handed."""
_CORE = 0.45  # half the height of the sphere's core, over the radius
_ROUND = 0.5  # shape of the core between a cube (0) and a ball (1)


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A quarter of beam and sphere: x along the beam, y across, z upwards, in m.

    x = 0 is mid-span, y = 0 mid-width (both planes of symmetry), z = 0 the beam's top, which the
    sphere touches at the origin.

    nodes: (n, 3). elements: (e, 8) node numbers in VTK's order of a hexahedron. body: (e,), BEAM or
    SPHERE. full: (e,), whether fully integrated. pairs: (p, 2) nodes (of the sphere, of the beam)
    with the same x and y, in a square, y fastest. gaps: (p,) initial distances in m. rim: (p,),
    pairs on the border of the matched patch. bulge: (f, points) in m of the sphere's faces, see
    impulses.bulges. normals: (p, 3) of the sphere, see impulses.close_gaps. symmetry_x, symmetry_y:
    nodes that keep their x (y). support: nodes that keep their z. axis_node: on the beam's axis at
    mid-span. element_size: of the patch, in m. patch: half the side of the square of matched nodes,
    in m.

    Raises ValueError when an element is inverted or has no volume at a corner.
    """

    nodes: Floats
    elements: Integers
    body: Integers
    full: NDArray[np.bool_]
    pairs: Integers
    gaps: Floats
    rim: NDArray[np.bool_]
    bulge: Floats
    normals: Floats
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

    @cached_property
    def faces(self) -> Integers:
        """Return the faces that may touch: four rows of pairs each, (f, 4)."""
        return _faces(len(self.pairs))

    @cached_property
    def pole(self) -> int:
        """Return the sphere's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 0])

    @cached_property
    def top_node(self) -> int:
        """Return the beam's node at the origin."""
        return int(self.pairs[np.argmin(self.gaps), 1])


def _faces(pairs: int) -> Integers:
    """Return the faces of a square of that many pairs, right-handed about z."""
    number = np.arange(pairs, dtype=np.int32).reshape(math.isqrt(pairs), -1)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, 4)


def plane_faces(
    nodes: Floats, elements: Integers, axis: int, element_size: float
) -> tuple[NDArray[np.int64], Integers]:
    """Return the faces in the plane through the origin across `axis` (0, 1, 2: x, y, z).

    Returns the element of each face, (faces,), and its nodes, (faces, 4).
    """
    corners = elements[:, FACES]
    near = np.abs(nodes[corners, axis]) < _FLAT * element_size
    element, face = np.nonzero(near.all(axis=2))
    return element, corners[element, face]


def _refuse_other_beams(impact: Impact) -> None:
    """Raise ValueError unless the beam is a pinned rectangular one with both planes of symmetry."""
    beam = impact.beam
    plain_values: list[tuple[Any, str, tuple[Any, ...]]] = [
        (beam, "shape", ("rectangle",)),
        (beam, "support_left", HINGES),
        (beam, "support_right", HINGES),
        (impact, "strike_position", (MID_SPAN,)),
        *((beam, field, (0.0,)) for field in RESISTANCES),
    ]
    for owner, field, plain in plain_values:
        if (value := getattr(owner, field)) not in plain:
            raise ValueError(
                f"{type(owner).__name__}.{field} = {value!r}: the 3-D model is a quarter of a "
                "rectangular pinned beam without damping or foundation, struck at mid-span: set it "
                f"to {plain[0]!r}"
            )


def check_mesh(mesh: Mesh, impact: Impact) -> None:
    """Raise ValueError where the mesh is that of other bodies."""
    _refuse_other_beams(impact)
    beam, nodes = impact.beam, mesh.nodes
    for name, meshed, length in (
        ("beam's span", 2.0 * nodes[mesh.support, 0].max(), beam.span),
        ("beam's width", 2.0 * nodes[mesh.support, 1].max(), beam.width),
        ("beam's depth", -nodes[:, 2].min(), beam.depth),
        ("sphere's radius", 0.5 * nodes[:, 2].max(), impact.sphere.radius),
    ):
        if not math.isclose(meshed, length, rel_tol=1e-9):
            raise ValueError(
                f"mesh: the {name} is {meshed:.9g} m in the mesh and {length:.9g} m in the "
                "impact: make the mesh from this impact (quarter_mesh)"
            )


def nodal_masses(mesh: Mesh, impact: Impact) -> Floats:
    """Return the lumped mass of each node in kg, (n,): an eighth of each of its elements.

    The sphere's density is that of sphere_density.
    """
    beam, sphere = impact.beam.material.density, sphere_density(mesh, impact)
    masses = np.repeat(np.where(mesh.body == BEAM, beam, sphere) * element_volumes(mesh) / 8.0, 8)
    return np.asarray(
        np.bincount(mesh.elements.ravel(), weights=masses, minlength=len(mesh.nodes)), dtype=float
    )


def sphere_density(mesh: Mesh, impact: Impact) -> float:
    """Return the density in kg/m3 with which all four quarters weigh what the impact says."""
    quarter = element_volumes(mesh)[mesh.body == SPHERE].sum()
    return float(impact.sphere.total_mass / 4.0 / quarter)


def element_volumes(mesh: Mesh) -> Floats:
    """Return each element's volume in m3, (e,): Gauss's rule of two points per side is exact."""
    points, total = mesh.nodes[mesh.elements], np.zeros(len(mesh.elements))
    for place in CORNERS / np.sqrt(3.0):
        factors = 1.0 + CORNERS * place
        slopes = [CORNERS[:, a] * np.prod(np.delete(factors, a, axis=1), axis=1) for a in range(3)]
        total += np.linalg.det(0.125 * np.stack(slopes) @ points)
    return total


def quarter_mesh(
    impact: Impact,
    *,
    element_size: float,
    patch: float | None = None,
    ratio: float = 1.3,
    coarsest: float | None = None,
) -> Mesh:
    """Return the mesh of the quarter model of `impact`.

    element_size: of the elements about the contact, in m. patch: half the side of the square in
    which nodes of sphere and beam are matched, in m, rounded up to whole elements (None: estimated
    from the impact). ratio: of neighbouring elements beyond the patch. coarsest: largest element
    in m (None: a sixth of the beam's depth).

    Raises ValueError when a length is not positive, the ratio not above 1, the element size beyond
    reason, the patch does not fit on beam and sphere, or the beam is no pinned one struck at
    mid-span.
    """
    _refuse_other_beams(impact)
    size, beam = checked_size(impact, element_size), impact.beam
    if positive("mesh", "ratio", ratio) <= 1.0:
        raise ValueError(f"mesh.ratio = {ratio!r}: must be above 1")
    limit = beam.depth / 6.0 if coarsest is None else coarsest
    largest = max(positive("mesh", "coarsest", limit), size)
    half = checked_patch(impact, size, patch)
    depth = size * max(round(half / size), 2)
    x, y = (graded(size, half, side / 2, ratio, largest) for side in (beam.span, beam.width))
    # The axis is one of the cuts along z. Where a last layer above it would be thin, all are alike.
    middle = beam.depth / 2
    fine = depth if middle - depth > 0.7 * size else middle
    upper = graded(size, fine, middle, ratio, largest)
    last = upper[-1] - upper[-2]
    lower = middle + graded(last, last, middle, ratio, largest)
    z = -np.concatenate([upper, lower[1:]])[::-1]
    axis = int(np.argmin(np.abs(z + middle)))

    beam_nodes, beam_elements = brick(x, y, z)
    sphere_nodes, sphere_elements, surface = quarter_sphere(
        impact.sphere.radius, size, half, depth, ratio, largest
    )
    first, count = len(beam_nodes), round(half / size) + 1
    place = np.arange(first, dtype=np.int32).reshape(x.size, y.size, z.size)
    above = surface[:count, :count] + np.int32(first)
    pairs = np.stack([above, place[:count, :count, -1]], axis=-1).reshape(-1, 2)
    rim = np.zeros((count, count), dtype=bool)
    rim[-1], rim[:, -1] = True, True
    nodes = np.concatenate([beam_nodes, sphere_nodes])
    nodes[pairs[:, 0], :2] = nodes[pairs[:, 1], :2]  # the same to the last bit
    elements = np.concatenate([beam_elements, sphere_elements + np.int32(first)])
    body = np.repeat(np.array([BEAM, SPHERE], np.int32), [len(beam_elements), len(sphere_elements)])
    centres = nodes[elements].mean(axis=1)
    full = np.all(np.abs(centres) < 1.5 * half, axis=1)
    # An infinite beam whose middle moves at v has M = v sqrt(rho A EI) there: does it yield?
    steel = beam.material
    yields = steel.yield_stress / math.sqrt(3.0 * steel.density * steel.youngs_modulus)
    if impact.velocity > yields:
        full |= (body == BEAM) & (centres[:, 0] < 2.5 * beam.depth)
    touching = nodes[pairs[:, 0]]
    slopes = touching[:, :2] / (impact.sphere.radius - touching[:, 2:])
    on_plane = np.abs(nodes[:, :2]) < 1e-6 * size
    symmetry_x, symmetry_y = (np.flatnonzero(on).astype(np.int32) for on in on_plane.T)
    return Mesh(
        nodes=nodes,
        elements=elements,
        body=body,
        full=full,
        pairs=pairs,
        gaps=nodes[pairs[:, 0], 2] - nodes[pairs[:, 1], 2],
        rim=rim.ravel(),
        bulge=bulges(nodes[pairs[_faces(len(pairs)), 0]], impact.sphere.radius),
        normals=np.column_stack([-slopes, np.ones(len(slopes))]),
        symmetry_x=symmetry_x,
        symmetry_y=symmetry_y,
        support=place[-1, :, axis],
        axis_node=int(place[0, 0, axis]),
        element_size=size,
        patch=half,
    )


def quarter_sphere(
    radius: float, size: float, patch: float, depth: float, ratio: float, largest: float
) -> tuple[Floats, Integers, Integers]:
    """Return nodes (n, 3) in m and elements (e, 8) of the quarter x >= 0, y >= 0 of a sphere.

    It touches z = 0 from above, at the origin. Also returns the lower surface's nodes by their
    place along x and y, (sides + 1, sides + 1). size: of the elements from the pole to x, y = patch
    and to `depth` into the sphere; beyond, they grow by `ratio` up to `largest`. Lengths in m.
    """
    lines = graded(size, patch, radius / math.sqrt(2.0), ratio, largest)
    shell = radius * (1.0 - _CORE)
    layers = 1.0 - graded(size, depth, shell, ratio, largest)[::-1] / shell
    sides, height = lines.size - 1, uniform(largest, radius * _CORE)
    count = round(patch / size)
    i, k = np.arange(sides + 1), np.arange(-height, height + 1)
    lattice = np.stack(np.meshgrid(i, i, k, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.int32)
    most = np.array([sides, sides, height])
    border = np.any(np.abs(lattice) == most, axis=1)
    # A rounded box over the radius: a cube, places in -1 to 1, blended with a ball.
    cube = lattice / most
    second, third = np.roll(cube**2, -1, axis=1), np.roll(cube**2, -2, axis=1)
    ball = cube * np.sqrt(1.0 - second / 2.0 - third / 2.0 + second * third / 3.0)
    inner = radius * (_CORE * ((1.0 - _ROUND) * cube + _ROUND * ball))
    # Of each border place: 0 in the patch, rising smoothly to 1 at the lower surface's edges.
    i, j, k = lattice[border].T
    away = np.clip((np.maximum(i, j) - count) / (sides - count), 0.0, 1.0)
    blend = np.where(k == -height, away**2 * (3.0 - 2.0 * away), 1.0)
    # On the unit sphere: x and y of the lines where blend is 0, rays where it is 1.
    rays = np.tan(math.pi / 4 * lattice[border] / most)
    outer = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    low = k == -height
    for axis, line in enumerate((i[low], j[low])):
        outer[low, axis] = (1.0 - blend[low]) * (lines / radius)[line] + blend[low] * outer[
            low, axis
        ]
    outer[low, 2] = -np.sqrt(1.0 - outer[low, 0] ** 2 - outer[low, 1] ** 2)
    outer *= radius
    # The share of the way out, (layers, border places): fine at the pole, even elsewhere.
    even = np.linspace(0.0, 1.0, layers.size)
    along = layers[:, None] * (1.0 - blend) + even[:, None] * blend
    shells = inner[border] + along[1:, :, None] * (outer - inner[border])
    nodes = np.concatenate([inner, shells.reshape(-1, 3)]) + np.array([0.0, 0.0, radius])
    elements, surface = _cells(border.reshape(sides + 1, sides + 1, -1), layers.size - 1)
    # Heights above the pole, without loss of digits.
    squares = nodes[surface, 0] ** 2 + nodes[surface, 1] ** 2
    nodes[surface, 2] = squares / (radius + np.sqrt(radius**2 - squares))
    return nodes, elements, surface


def _cells(border: NDArray[np.bool_], layers: int) -> tuple[Integers, Integers]:
    """Return elements and lower surface's nodes; border: that of the core's lattice (i, j, k)."""
    number = np.arange(border.size, dtype=np.int32).reshape(border.shape)
    shell = np.full((layers + 1, *border.shape), -1, dtype=np.int32)
    shell[0] = number
    shell[1:, border] = border.size + np.arange(layers * border.sum()).reshape(layers, -1)
    faces = (  # each a lattice (a, b, layer) whose axes turn right-handed
        shell[:, :, :, 0].transpose(2, 1, 0),
        shell[:, :, :, -1].transpose(1, 2, 0),
        shell[:, -1].transpose(1, 2, 0),
        shell[:, :, -1].transpose(2, 1, 0),
    )
    return np.concatenate([cells(number), *map(cells, faces)]), shell[-1, :, :, 0]


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
