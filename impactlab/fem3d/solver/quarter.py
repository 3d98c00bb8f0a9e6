"""The mesh of an impact: a quarter of the beam and one of the sphere, matched where they touch.

The sphere is a core of hexahedra with shells around it, out to the surface. The core is a lattice
(i, j, k) with i and j from 0 to `sides` and k from -height to height; each of its boundary nodes
sends a line out to the sphere's surface, cut by the layers. Surface nodes near the pole have the x
and y of the beam's; from there the lines flare out into an evenly cut core.
"""

from __future__ import annotations

import math

import numpy as np

from impactlab.fem3d.solver.estimates import bending_yields, checked_patch, checked_size
from impactlab.fem3d.solver.mesh import (
    BEAM,
    SPHERE,
    Floats,
    Integers,
    Mesh,
    Truths,
    brick,
    cells,
    graded,
    uniform,
)
from impactlab.model.checks import positive
from impactlab.model.impact import Impact

_BENT = 2.5
"""Length of beam beside the impact, over its depth, that is fully integrated where it may yield."""
_THINNEST = 0.7
"""Thickness of a layer of elements at least, over their size in the contact."""
_CORE = 0.45
"""Half the height of the sphere's core, over the radius."""
_ROUND = 0.5
"""Shape of the core between a cube (0) and a ball (1)."""


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
    reason, or the patch does not fit on beam and sphere.
    """
    size, beam = checked_size(impact, element_size), impact.beam
    if positive("mesh", "ratio", ratio) <= 1.0:
        raise ValueError(f"mesh.ratio = {ratio!r}: must be above 1")
    given = beam.depth / 6.0 if coarsest is None else coarsest
    largest = max(positive("mesh", "coarsest", given), size)
    half = checked_patch(impact, size, patch)
    depth = size * max(round(half / size), 2)
    x, y = (graded(size, half, side / 2, ratio, largest) for side in (beam.span, beam.width))
    z = _heights(beam.depth / 2, size, depth, ratio, largest)
    axis = int(np.argmin(np.abs(z + beam.depth / 2)))

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
    if bending_yields(impact):
        full |= (body == BEAM) & (centres[:, 0] < _BENT * beam.depth)
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
        symmetry_x=symmetry_x,
        symmetry_y=symmetry_y,
        support=place[-1, :, axis],
        axis_node=int(place[0, 0, axis]),
        element_size=size,
        patch=half,
    )


def _heights(middle: float, size: float, depth: float, ratio: float, largest: float) -> Floats:
    """Return the beam's cuts along z, ascending, of which one is its axis at -middle (m)."""
    # Where little is left for a last layer above the axis, which would be thin, all are alike.
    fine = depth if middle - depth > _THINNEST * size else middle
    upper = graded(size, fine, middle, ratio, largest)
    last = upper[-1] - upper[-2]
    lower = middle + graded(last, last, middle, ratio, largest)
    return -np.concatenate([upper, lower[1:]])[::-1]


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
    one, two = np.roll(cube**2, -1, axis=1), np.roll(cube**2, -2, axis=1)
    ball = cube * np.sqrt(1.0 - one / 2.0 - two / 2.0 + one * two / 3.0)
    inner = radius * (_CORE * ((1.0 - _ROUND) * cube + _ROUND * ball))
    outer = radius * _surface(lattice[border], lines / radius, count, height)
    # The share of the way out, (layers, border places): fine at the pole, even elsewhere.
    i, j, k = lattice[border].T
    blend = np.where(k == -height, _away(i, j, count, sides), 1.0)
    even = np.linspace(0.0, 1.0, layers.size)
    along = layers[:, None] * (1.0 - blend) + even[:, None] * blend
    shells = inner[border] + along[1:, :, None] * (outer - inner[border])
    nodes = np.concatenate([inner, shells.reshape(-1, 3)]) + np.array([0.0, 0.0, radius])
    elements, surface = _cells(border.reshape(sides + 1, sides + 1, -1), layers.size - 1)
    # Heights above the pole, without loss of digits.
    squares = nodes[surface, 0] ** 2 + nodes[surface, 1] ** 2
    nodes[surface, 2] = squares / (radius + np.sqrt(radius**2 - squares))
    return nodes, elements, surface


def _surface(lattice: Integers, lines: Floats, patch: int, height: int) -> Floats:
    """Return points of the unit sphere: x and y of the lines in the patch, even rays elsewhere."""
    sides = lines.size - 1
    rays = np.tan(math.pi / 4 * lattice / np.array([sides, sides, height]))
    points = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    low = lattice[:, 2] == -height
    i, j = lattice[low, 0], lattice[low, 1]
    blend = _away(i, j, patch, sides)
    for axis, at in enumerate((i, j)):
        points[low, axis] = (1.0 - blend) * lines[at] + blend * points[low, axis]
    points[low, 2] = -np.sqrt(1.0 - points[low, 0] ** 2 - points[low, 1] ** 2)
    return np.asarray(points)


def _away(i: Integers, j: Integers, patch: int, sides: int) -> Floats:
    """Return 0 in the patch, rising smoothly to 1 at the lower surface's edges."""
    t = np.clip((np.maximum(i, j) - patch) / (sides - patch), 0.0, 1.0)
    return np.asarray(t**2 * (3.0 - 2.0 * t))


def _cells(border: Truths, layers: int) -> tuple[Integers, Integers]:
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
