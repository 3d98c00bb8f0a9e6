"""The contact of sphere and beam: impulses, integrated over the faces that may touch.

A step's motion is predicted without contact. At each integration point of a face, the overlap at
the step's end asks for an impulse per area that would close it if the faces around overlapped
alike; a pair of nodes receives the mean over its parts of the faces. So where the surfaces touch
all around, they are on each other at the step's end, and a face at the edge of the contact gives
the part of the force that belongs to its part in contact. There is no stiffness to choose. The
overlaps left at the edge vanish with the element size.
Source of the impulses, for pairs of nodes: N. J. Carpenter, R. L. Taylor and M. G. Katona, Int. J.
Numer. Meth. Engng. 32 (1991) 103. Overlaps at integration points are those of K. A. Fischer and
P. Wriggers, Comput. Mech. 36 (2005) 226 (recalled), without their penalty.
"""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.jit import Array, compiled
from impactlab.types import Floats

_SIDE = 4
"""Integration points along a face's side."""
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(_SIDE)
_XI, _ETA = (place.ravel() for place in np.meshgrid(_PLACES, _PLACES, indexing="ij"))
SHAPE = 0.25 * np.stack(
    [
        (1 + _XI * sign_x) * (1 + _ETA * sign_y)
        for sign_x, sign_y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ],
    axis=1,
)
"""Shape functions of a face's corners at its integration points, (points, 4)."""
PARTS = SHAPE * np.outer(_WEIGHTS, _WEIGHTS).reshape(-1, 1)
"""Parts of a point's overlap that belong to the corners, of sum 1 for each corner, (points, 4)."""
RULE = SHAPE, PARTS
"""Integration over a face; at its corners alone, the contact would be one of pairs of nodes."""


def bulges(corners: Floats, radius: float) -> Floats:
    """Return how far a sphere lies below its flat faces at their integration points, in m.

    corners: (f, 4, 3) on the sphere of this radius that touches z = 0 from above at the origin.
    Returns (f, points).
    """
    x, y, z = np.moveaxis(SHAPE @ corners, -1, 0)
    squares = x**2 + y**2
    return np.asarray(z - squares / (radius + np.sqrt(radius**2 - squares)))


@compiled
def close_gaps(
    rule: tuple[Array, Array],
    faces: Array,
    bulge: Array,
    share: Array,
    pairs: Array,
    rim: Array,
    inverse_mass: Array,
    x: Array,
    v: Array,
    dt: float,
    approach: Array,
    closing: Array,
) -> tuple[float, float, float, bool]:
    """Correct x (m, at the step's end) and v (m/s, at its middle) where the bodies would overlap.

    Impulses are equal and opposite on a pair: momentum is kept. They only push.

    rule: see RULE. faces: (f, 4) rows of pairs. bulge: (f, points) in m, see bulges. share: (p,),
    one over a pair's number of faces. pairs: (p, 2) nodes, of the upper and the lower body. rim:
    (p,). inverse_mass: (n, 3) in 1/kg. approach: (p,) their relative velocity in m/s in the step
    before, replaced by this one's. closing: (p,), replaced by the distances in m by which pairs
    were parted.

    Returns the sum of the impulses in N s; the energy in J that their halves take from the bodies
    before and after the moment at which they act; and whether nodes on the rim have met.
    """
    shape, parts = rule
    closing[:] = 0.0
    for f in range(faces.shape[0]):
        a, b, c, d = faces[f, 0], faces[f, 1], faces[f, 2], faces[f, 3]
        gap_a = x[pairs[a, 0], 2] - x[pairs[a, 1], 2]
        gap_b = x[pairs[b, 0], 2] - x[pairs[b, 1], 2]
        gap_c = x[pairs[c, 0], 2] - x[pairs[c, 1], 2]
        gap_d = x[pairs[d, 0], 2] - x[pairs[d, 1], 2]
        for q in range(shape.shape[0]):
            level = shape[q, 0] * gap_a + shape[q, 1] * gap_b
            level += shape[q, 2] * gap_c + shape[q, 3] * gap_d
            overlap = bulge[f, q] - level
            if overlap > 0.0:
                closing[a] += parts[q, 0] * overlap
                closing[b] += parts[q, 1] * overlap
                closing[c] += parts[q, 2] * overlap
                closing[d] += parts[q, 3] * overlap
    impulse, before, after, beyond = 0.0, 0.0, 0.0, False
    for p in range(pairs.shape[0]):
        upper, lower = pairs[p]
        push = 0.0
        if closing[p] > 0.0:
            beyond = beyond or (rim[p] and x[upper, 2] < x[lower, 2])
            up, down = inverse_mass[upper, 2], inverse_mass[lower, 2]
            closing[p] *= share[p]
            push = closing[p] / (dt * (up + down))
            v[upper, 2] += push * up
            v[lower, 2] -= push * down
            x[upper, 2] += dt * push * up
            x[lower, 2] -= dt * push * down
        moving = v[lower, 2] - v[upper, 2]
        impulse += push
        before += 0.5 * push * approach[p]
        after += 0.5 * push * moving
        approach[p] = moving
    return impulse, before, after, beyond
