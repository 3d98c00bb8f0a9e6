"""The mesh of an impact: a quarter of the beam and one of the sphere, matched where they touch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from impactlab.fem3d.solver.mesh.estimates import bending_yields, checked_patch, checked_size
from impactlab.fem3d.solver.mesh.mesh import BEAM, SPHERE, Mesh, brick, graded
from impactlab.fem3d.solver.mesh.sphere import Sphere, quarter_sphere
from impactlab.model.checks import positive
from impactlab.model.impact import Beam, Impact

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]

_BENT = 2.5
"""Length of beam beside the impact, over its depth, that is fully integrated where it may yield."""
_THINNEST = 0.7
"""Thickness of a layer of elements at least, over their size in the contact."""


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
    size = checked_size(impact, element_size)
    if positive("mesh", "ratio", ratio) <= 1.0:
        raise ValueError(f"mesh.ratio = {ratio!r}: must be above 1")
    given = impact.beam.depth / 6.0 if coarsest is None else coarsest
    largest = max(positive("mesh", "coarsest", given), size)
    half = checked_patch(impact, size, patch)
    depth = size * max(round(half / size), 2)
    sphere = quarter_sphere(impact.sphere.radius, size, half, depth, ratio, largest)
    x, y, z = _cuts(impact.beam, size, half, depth, ratio, largest)
    return _joined(impact, (x, y, z), sphere, size, half)


def _cuts(
    beam: Beam, size: float, half: float, depth: float, ratio: float, largest: float
) -> tuple[Floats, Floats, Floats]:
    """Return the cuts of the beam along x, y and z (ascending); z holds its axis.

    A last layer above the axis would be thin where little is left for it: then all are alike.
    """
    x = graded(size, half, beam.span / 2, ratio, largest)
    y = graded(size, half, beam.width / 2, ratio, largest)
    fine = depth if beam.depth / 2 - depth > _THINNEST * size else beam.depth / 2
    upper = graded(size, fine, beam.depth / 2, ratio, largest)
    last = upper[-1] - upper[-2]
    lower = beam.depth / 2 + graded(last, last, beam.depth / 2, ratio, largest)
    return x, y, -np.concatenate([upper, lower[1:]])[::-1]


def _joined(
    impact: Impact,
    cuts: tuple[Floats, Floats, Floats],
    sphere: Sphere,
    size: float,
    half: float,
) -> Mesh:
    x, y, z = cuts
    nodes, elements = brick(*cuts)
    count = round(half / size) + 1
    place = np.arange(nodes.shape[0]).reshape(x.size, y.size, z.size)
    above = sphere.surface[:count, :count] + nodes.shape[0]
    pairs = np.stack([above, place[:count, :count, -1]], axis=-1)
    rim = np.zeros((count, count), dtype=bool)
    rim[-1], rim[:, -1] = True, True
    every = np.concatenate([nodes, sphere.nodes])
    every[above, :2] = nodes[pairs[..., 1], :2]  # the same to the last bit
    joined = np.concatenate([elements, sphere.elements + nodes.shape[0]]).astype(np.int32)
    body = np.repeat(np.array([BEAM, SPHERE], np.int32), [len(elements), len(sphere.elements)])
    axis = int(np.argmin(np.abs(z + impact.beam.depth / 2)))
    pairs = pairs.reshape(-1, 2).astype(np.int32)
    return Mesh(
        nodes=every,
        elements=joined,
        body=body,
        full=_full(impact, every[joined].mean(axis=1), body, half),
        pairs=pairs,
        gaps=every[pairs[:, 0], 2] - every[pairs[:, 1], 2],
        rim=rim.ravel(),
        symmetry_x=_plane(every, 0, size),
        symmetry_y=_plane(every, 1, size),
        support=place[-1, :, axis].astype(np.int32),
        axis_node=int(place[0, 0, axis]),
        element_size=size,
        patch=half,
    )


def _plane(nodes: Floats, axis: int, size: float) -> Integers:
    """Return the nodes on the plane of symmetry across `axis`."""
    return np.flatnonzero(np.abs(nodes[:, axis]) < 1e-6 * size).astype(np.int32)


def _full(impact: Impact, centres: Floats, body: Integers, half: float) -> NDArray[np.bool_]:
    """Return which elements to integrate fully: near the contact, and mid-beam if it yields."""
    near = np.all(np.abs(centres) < 1.5 * half, axis=1)
    bent = (body == BEAM) & (centres[:, 0] < _BENT * impact.beam.depth)
    return np.asarray(near | bent if bending_yields(impact) else near)
