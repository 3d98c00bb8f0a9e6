"""The quarter of the sphere: a core of hexahedra with shells around it, out to the surface.

The core is a lattice (i, j, k) with i and j from 0 to `sides` and k from -height to height; each of
its boundary nodes sends a line out to the sphere's surface, cut by the layers. Surface nodes near
the pole have the x and y of the beam's; from there the lines flare out into an evenly cut core.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impactlab.fem3d.solver.mesh.mesh import cells, graded, uniform

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]

_CORE = 0.45
"""Half the core's height, over the radius."""
_ROUND = 0.5
"""Shape of the core between a cube (0) and a ball (1)."""


@dataclass(frozen=True)
class Sphere:
    """A meshed quarter sphere. nodes: (n, 3) in m, the lowest at the origin. elements: (e, 8).

    surface: (sides + 1, sides + 1), the lower surface's nodes by their place along x and y.
    """

    nodes: Floats
    elements: Integers
    surface: Integers


def quarter_sphere(
    radius: float, size: float, patch: float, depth: float, ratio: float, largest: float
) -> Sphere:
    """Return the quarter x >= 0, y >= 0 of a sphere that touches z = 0 from above (lengths in m).

    size: of the elements from the pole to x, y = patch and to `depth` into the sphere; beyond, they
    grow by `ratio` up to `largest`.
    """
    lines = graded(size, patch, radius / math.sqrt(2.0), ratio, largest)
    layers = 1.0 - graded(size, depth, radius * (1.0 - _CORE), ratio, largest)[::-1] / (
        radius * (1.0 - _CORE)
    )
    sides, height = lines.size - 1, uniform(largest, radius * _CORE)
    lattice = _lattice(sides, height)
    border = _on_border(lattice, sides, height)
    inner = radius * _core(lattice / np.array([sides, sides, height]))
    outer = radius * _surface(lattice[border], lines / radius, round(patch / size), height)
    along = _along(lattice[border], layers, round(patch / size), sides, height)
    shells = inner[border] + along[1:, :, None] * (outer - inner[border])
    nodes = np.concatenate([inner, shells.reshape(-1, 3)]) + np.array([0.0, 0.0, radius])
    number = np.arange(lattice.shape[0], dtype=np.int32).reshape(sides + 1, sides + 1, -1)
    elements, surface = _elements(number, border, layers.size - 1)
    nodes[surface, 2] = _height(nodes[surface], radius)
    return Sphere(nodes, elements, surface)


def _lattice(sides: int, height: int) -> Integers:
    """Return all places (i, j, k) of the core, (n, 3)."""
    i, k = np.arange(sides + 1), np.arange(-height, height + 1)
    return np.stack(np.meshgrid(i, i, k, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.int32)


def _on_border(lattice: Integers, sides: int, height: int) -> NDArray[np.bool_]:
    i, j, k = lattice.T
    return np.asarray((i == sides) | (j == sides) | (np.abs(k) == height))


def _core(place: Floats) -> Floats:
    """Return a rounded box over the radius, from places in -1 to 1: a cube blended with a ball."""
    squares = place**2
    one, two = np.roll(squares, -1, axis=1), np.roll(squares, -2, axis=1)
    ball = place * np.sqrt(1.0 - one / 2.0 - two / 2.0 + one * two / 3.0)
    return np.asarray(_CORE * ((1.0 - _ROUND) * place + _ROUND * ball))


def _surface(lattice: Integers, lines: Floats, patch: int, height: int) -> Floats:
    """Return points of the unit sphere for border places: even rays through a cube but the patch.

    There, and smoothly less beyond, x and y are those of the lines.
    """
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


def _along(lattice: Integers, layers: Floats, patch: int, sides: int, height: int) -> Floats:
    """Return the share of the way out, (layers, border places): fine at the pole."""
    i, j, k = lattice.T
    blend = np.where(k == -height, _away(i, j, patch, sides), 1.0)
    even = np.linspace(0.0, 1.0, layers.size)
    return np.asarray(layers[:, None] * (1.0 - blend) + even[:, None] * blend)


def _elements(
    number: Integers, border: NDArray[np.bool_], layers: int
) -> tuple[Integers, Integers]:
    """Return the cells of core and shells, and the node numbers of the lower surface."""
    shell = np.full((layers + 1, number.size), -1, dtype=np.int32)
    shell[0] = number.ravel()
    count = int(border.sum())
    first = number.size + count * np.arange(layers)[:, None]
    shell[1:, border] = first + np.arange(count)
    shell = shell.reshape(layers + 1, *number.shape)
    faces = (  # each a lattice (a, b, layer) whose axes turn right-handed
        shell[:, :, :, 0].transpose(2, 1, 0),
        shell[:, :, :, -1].transpose(1, 2, 0),
        shell[:, -1].transpose(1, 2, 0),
        shell[:, :, -1].transpose(2, 1, 0),
    )
    return np.concatenate([cells(number), *map(cells, faces)]), shell[-1, :, :, 0]


def _height(points: Floats, radius: float) -> Floats:
    """Return z in m of the lower surface above its pole, without loss of digits."""
    squares = points[..., 0] ** 2 + points[..., 1] ** 2
    return np.asarray(squares / (radius + np.sqrt(radius**2 - squares)))
