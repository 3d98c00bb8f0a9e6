"""The quarter of the beam: a brick of graded hexahedra."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]


def brick(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Integers]:
    """Nodes (n, 3) in m and elements (e, 8) of a brick cut at ascending x, y and z.

    Nodes are numbered with z fastest, x slowest: (i ny + j) nz + k.
    """
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(nodes.shape[0], dtype=np.int32).reshape(x.size, y.size, z.size)
    return nodes, cells(number)


def cells(number: Integers) -> Integers:
    """The hexahedra, (e, 8) in VTK's order, of a lattice of node numbers (i, j, k)."""
    low, high = slice(None, -1), slice(1, None)
    ring = ((low, low), (high, low), (high, high), (low, high))
    corners = [number[(*place, level)] for level in (low, high) for place in ring]
    return np.stack(corners, axis=-1).reshape(-1, 8)
