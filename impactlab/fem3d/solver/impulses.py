"""The contact of sphere and beam: impulses, integrated over the faces that may touch.

A step's motion is predicted without contact. At each integration point of a face, the overlap at
the step's end asks for an impulse per area that would close it if the faces around overlapped
alike; a pair of nodes receives the mean over its parts of the faces. So where the surfaces touch
all around, they are on each other at the step's end, and a face at the edge of the contact gives
the part of the force that belongs to its part in contact. There is no stiffness to choose. The
overlaps left at the edge vanish with the element size.
Metal that flows slides along the sphere, by 1 % of its radius of contact and more: a pair's
distance is that of the lower node from the tangent of the (undeformed) sphere at the upper one, and
impulses act across the tangent.
Source of the impulses, for pairs of nodes: N. J. Carpenter, R. L. Taylor and M. G. Katona, Int. J.
Numer. Meth. Engng. 32 (1991) 103. Overlaps at integration points are those of K. A. Fischer and
P. Wriggers, Comput. Mech. 36 (2005) 226 (recalled), without their penalty.
"""

import numpy as np

from impactlab.fem3d.solver.compiler import Array, compiled, inlined
from impactlab.types import Floats

_SIDE = 4  # integration points along a face's side
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
RULE = SHAPE, PARTS  # at the corners alone, the contact would be one of pairs of nodes


def bulges(corners: Floats, radius: float) -> Floats:
    """Return how far a sphere lies below its flat faces at their integration points, in m.

    corners: (f, 4, 3) on the sphere of this radius that touches z = 0 from above at the origin.
    Returns (f, points).
    """
    x, y, z = np.moveaxis(SHAPE @ corners, -1, 0)
    squares = x**2 + y**2
    return np.asarray(z - squares / (radius + np.sqrt(radius**2 - squares)))


@inlined
def apart(pair: Array, normal: Array, x: Array) -> float:
    """Return how far the sphere's tangent is above the lower node, in the unit of x."""
    upper, lower = pair
    beside = normal[0] * (x[upper, 0] - x[lower, 0]) + normal[1] * (x[upper, 1] - x[lower, 1])
    return float(beside + normal[2] * (x[upper, 2] - x[lower, 2]))


@compiled
def close_gaps(
    rule: tuple[Array, Array],
    faces: Array,
    bulge: Array,
    share: Array,
    pairs: Array,
    rim: Array,
    normals: Array,
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
    (p,). normals: (p, 3), (-s_x, -s_y, 1) where the upper body's surface has slopes s_x and s_y.
    inverse_mass: (n, 3) in 1/kg. approach: (p,) the rate in m/s at which gaps closed in the step
    before, replaced by this one's. closing: (p,), replaced by the distances in m by which pairs
    were parted.

    Returns the sum of the impulses' vertical parts in N s; the energy in J that their halves take
    from the bodies before and after the moment at which they act; and whether nodes on the rim have
    met.
    """
    shape, parts = rule
    closing[:] = 0.0
    for f in range(faces.shape[0]):
        a, b, c, d = faces[f, 0], faces[f, 1], faces[f, 2], faces[f, 3]
        gap_a, gap_b = apart(pairs[a], normals[a], x), apart(pairs[b], normals[b], x)
        gap_c, gap_d = apart(pairs[c], normals[c], x), apart(pairs[d], normals[d], x)
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
            closing[p] *= share[p]
            moved = 0.0  # by a unit impulse
            for k in range(3):
                moved += normals[p, k] ** 2 * (inverse_mass[upper, k] + inverse_mass[lower, k])
            push = closing[p] / (dt * moved)
            for k in range(3):
                up = push * normals[p, k] * inverse_mass[upper, k]
                down = push * normals[p, k] * inverse_mass[lower, k]
                v[upper, k] += up
                v[lower, k] -= down
                x[upper, k] += dt * up
                x[lower, k] -= dt * down
        moving = -apart(pairs[p], normals[p], v)
        impulse += push
        before += 0.5 * push * approach[p]
        after += 0.5 * push * moving
        approach[p] = moving
    return impulse, before, after, beyond
