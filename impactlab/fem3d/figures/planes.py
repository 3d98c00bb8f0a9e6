"""Faces of a 3-D mesh that lie in a plane, as polygons."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

BEAM, SPHERE = 0, 1
"""Values of `body`."""
_FACES = np.array(
    [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
)
"""Corners of a hexahedron's faces, in VTK's order."""
_FLAT = 1e-6
"""Distance from the plane over the size of elements that is none."""


def faces(solid: xr.Dataset, axis: int) -> tuple[Floats, Integers]:
    """Faces in the plane through the origin across `axis` (0, 1, 2: x, y, z).

    Returns their corners in mm, (faces, 4, 2), in the other two axes, and the number of the
    element that each belongs to, (faces,).
    """
    nodes, elements = solid["node_position"].values, solid["element_nodes"].values
    corners = elements[:, _FACES]
    near = np.abs(nodes[corners, axis]) < _FLAT * float(solid["element_size"])
    element, face = np.nonzero(near.all(axis=2))
    places = nodes[corners[element, face]]
    return 1e3 * np.delete(places, axis, axis=2), element


def draw(ax: Axes, polygons: Floats, **looks: Any) -> PolyCollection:
    """Polygons on axes of equal scale. The limits are the caller's."""
    drawn = PolyCollection(list(polygons), **looks)
    ax.add_collection(drawn)
    ax.set_aspect("equal")
    ax.grid(visible=False)
    return drawn
