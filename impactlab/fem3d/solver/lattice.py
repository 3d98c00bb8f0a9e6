"""Hexahedra of a beam and of a sphere, cut along graded lines.

A beam is fine at the beginning of its lines and coarser with the distance. A sphere is a core of
hexahedra with shells around it, out to the surface. The core is a lattice (i, j, k) with i and j
from 0 to `sides` and k from -height to height; each of its boundary nodes sends a line out to the
sphere's surface, cut by the layers. Surface nodes near the pole have the x and y of the beam's;
from there the lines flare out into an evenly cut core.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from impactlab.fem3d.solver.estimates import uniform
from impactlab.types import Floats

Integers = NDArray[np.int32]

_CORE = 0.45  # half the height of the sphere's core, over the radius
_ROUND = 0.5  # shape of the core between a cube (0) and a ball (1)


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


def mirrored(
    nodes: Floats, elements: Integers, surface: Integers
) -> tuple[Floats, Integers, Integers]:
    """Return a part of a sphere with its mirror image across x = 0; see quarter_sphere."""
    beside = nodes[:, 0] != 0.0
    image = np.arange(len(nodes), dtype=np.int32)
    image[beside] = len(nodes) + np.arange(beside.sum())
    turned = image[elements][:, [1, 0, 3, 2, 5, 4, 7, 6]]  # right-handed again
    return (
        np.concatenate([nodes, nodes[beside] * [-1.0, 1.0, 1.0]]),
        np.concatenate([elements, turned]),
        np.concatenate([image[surface[:0:-1]], surface]),
    )


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
