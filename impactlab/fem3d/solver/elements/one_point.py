"""The hexahedron with one integration point: mean strain, and stiffness against hourglassing.

Hourglass rates q_a = h_a - L g_a (four vectors, a = 1 to 4) are what a velocity holds beyond its
mean gradient L. In a frame that turns with the element they strain a brick of half edges a_1, a_2,
a_3 by fields linear in xi, eta and zeta. Assumed of these strains: the shears that bending would
bring along vanish, stresses across bent fibres are free, twist keeps its shear. So a brick bends
and twists as a beam or plate does, and no number has to be chosen. These stresses stay elastic.
Source: the assumed strains follow T. Belytschko and L. P. Bindeman, Comput. Methods Appl. Mech.
Engng. 105 (1993) 225; the projection D. P. Flanagan and T. Belytschko (1981).
"""

from __future__ import annotations

import math

from impactlab.fem3d.solver.elements.hexahedron import (
    Shape,
    Tensor,
    V,
    Vector,
    W,
    X,
    apply,
    combine,
    cross,
    dot,
    gather,
    gradient,
    load,
    mean_gradient,
    midway,
    nodal,
    plus,
    scatter,
    shape,
    store,
    times,
    volume,
)
from impactlab.fem3d.solver.jit import Array, compiled, inlined
from impactlab.fem3d.solver.material import POINT_ROWS, Metal, advance

Four = tuple[Vector, Vector, Vector, Vector]

POINTS = 1
"""Integration points, whose rows come first in `state`."""
MEAN, WORK, DISSIPATED, HOURGLASS_WORK = (POINT_ROWS + n for n in range(4))
"""Rows of the mean stress (Pa) and of energies (J)."""
_HOURGLASS_ROWS = 12
"""Hourglass forces in N, in the element's frame: three of a = 1, three of a = 2, ..."""
_Q = POINT_ROWS + 4
ROWS = _Q + _HOURGLASS_ROWS
"""Rows of `state`."""


@compiled
def one_point_forces(
    blocks: tuple[int, int],
    nodes: Array,
    rows: Array,
    x: Array,
    v: Array,
    dt: float,
    metal: Metal,
    state: Array,
    forces: Array,
    s: Array,
) -> None:
    """Take a step's motion into `state`, and add the nodal forces that answer it.

    blocks: the first and the one past the last. nodes, and the rows of forces that are theirs:
    (blocks, 8 W). x: (n, 3) in m, at the step's end; v: (n, 3) in m/s, at its middle; dt in s.
    state: (blocks, ROWS W). forces: (., 3) in N. s: scratch, (SCRATCH W,).
    """
    for block in range(blocks[0], blocks[1]):
        gather(s, nodes[block], x, v)
        for lane in range(W):
            _element(s, state[block], lane, dt, metal)
        scatter(s, rows[block], forces)


@inlined
def _element(s: Array, state: Array, lane: int, dt: float, metal: Metal) -> None:
    """Update an element's stresses, and store its nodal forces in `s`."""
    c, w = shape(s, X, lane), shape(s, V, lane)
    B = gradient(c)
    size = volume(c, B)
    L = mean_gradient(w, B, size)
    Q, work = hourglass(state, _Q, lane, c, w, L, size, dt, metal)
    state[HOURGLASS_WORK * W + lane] += work
    L = midway(L, dt)
    S, work, dissipated = advance(state, 0, lane, L, dt, metal)
    dilation = dt * (L[0][0] + L[1][1] + L[2][2])
    before = state[MEAN * W + lane]
    mean = before + metal[3] * dilation
    state[MEAN * W + lane] = mean
    state[WORK * W + lane] += size * (work + 0.5 * (before + mean) * dilation)
    state[DISSIPATED * W + lane] += size * dissipated
    share, g = 1.0 / size, (c[3], c[4], c[5], c[6])
    T = (
        _row((S[0] + mean, S[5], S[4]), g, Q, 0, share),
        _row((S[5], S[1] + mean, S[3]), g, Q, 1, share),
        _row((S[4], S[3], S[2] + mean), g, Q, 2, share),
    )
    forces = (
        times(0.125, apply(T, B[0])),
        times(0.125, apply(T, B[1])),
        times(0.125, apply(T, B[2])),
        times(0.125, plus(apply(T, B[3]), 1.0, Q[0])),
        times(0.125, plus(apply(T, B[4]), 1.0, Q[1])),
        times(0.125, plus(apply(T, B[5]), 1.0, Q[2])),
        times(0.125, Q[3]),
    )
    nodal(s, lane, forces)


@inlined
def _row(stress: Vector, g: Four, Q: Four, axis: int, share: float) -> Vector:
    """Return a row of the stress, minus the hourglass forces' part in the mean gradient."""
    taken = combine((g[0], g[1], g[2]), (Q[0][axis], Q[1][axis], Q[2][axis]))
    return plus(stress, -share, plus(taken, Q[3][axis], g[3]))


@inlined
def hourglass(
    state: Array,
    row: int,
    lane: int,
    c: Shape,
    w: Shape,
    L: Tensor,
    V: float,
    dt: float,
    metal: Metal,
) -> tuple[Four, float]:
    """Return the four hourglass forces (N) at a step's end, and their work (J) in it.

    L: dv/dx at the step's end. row: the first in `state` of the forces, which are updated.
    """
    e = _frame(c)
    half = (dot(e[0], c[0]), dot(e[1], c[1]), dot(e[2], c[2]))
    q1, q2 = _rate(e, c[3], w[3], L), _rate(e, c[4], w[4], L)
    q3, q4 = _rate(e, c[5], w[5], L), _rate(e, c[6], w[6], L)
    p1, p2, p3, p4 = _stiffness((q1, q2, q3, q4), half, V * dt, metal)
    Q1, one = _raised(state, row, lane, p1, q1)
    Q2, two = _raised(state, row + 3, lane, p2, q2)
    Q3, three = _raised(state, row + 6, lane, p3, q3)
    Q4, four = _raised(state, row + 9, lane, p4, q4)
    work = dt * ((one + two) + (three + four))
    return (combine(e, Q1), combine(e, Q2), combine(e, Q3), combine(e, Q4)), work


@inlined
def _frame(c: Shape) -> Tensor:
    """Return unit vectors: along c_1, in the plane of c_1 and c_2, across it."""
    along = times(1.0 / math.sqrt(dot(c[0], c[0])), c[0])
    across = cross(c[0], c[1])
    across = times(1.0 / math.sqrt(dot(across, across)), across)
    return (along, cross(across, along), across)


@inlined
def _rate(e: Tensor, g: Vector, h: Vector, L: Tensor) -> Vector:
    """Return h - L g in the frame, in m/s."""
    return apply(e, plus(h, -1.0, apply(L, g)))


@inlined
def _stiffness(q: Four, half: Vector, V: float, metal: Metal) -> Four:
    """Return the forces against hourglass motions q: brick means of stress times strain."""
    q1, q2, q3, q4 = q
    E, nu, G = metal[0], metal[1], metal[2]
    i1, i2, i3 = 1.0 / half[0], 1.0 / half[1], 1.0 / half[2]
    plate, shear, fibre = V * E / (3.0 * (1.0 - nu * nu)), V * G / 3.0, V * E / 9.0
    y3, z2 = _pair(plate, nu, q3[1] * i2, q2[2] * i3)  # varies with xi
    x3, z1 = _pair(plate, nu, q3[0] * i1, q1[2] * i3)  # with eta
    x2, y1 = _pair(plate, nu, q2[0] * i1, q1[1] * i2)  # with zeta
    t1 = shear * (q3[2] * i2 + q2[1] * i3)
    t2 = shear * (q3[2] * i1 + q1[0] * i3)
    t3 = shear * (q1[0] * i2 + q2[1] * i1)
    return (
        (t2 * i3 + t3 * i2, y1 * i2, z1 * i3),
        (x2 * i1, t1 * i3 + t3 * i1, z2 * i3),
        (x3 * i1, y3 * i2, t1 * i2 + t2 * i1),
        (fibre * i1 * i1 * q4[0], fibre * i2 * i2 * q4[1], fibre * i3 * i3 * q4[2]),
    )


@inlined
def _pair(plate: float, nu: float, one: float, other: float) -> tuple[float, float]:
    """Return stresses of two normal strains that vary alike, the third direction free of stress."""
    return plate * (one + nu * other), plate * (other + nu * one)


@inlined
def _raised(state: Array, row: int, lane: int, rise: Vector, q: Vector) -> tuple[Vector, float]:
    """Raise three forces; return them and the power of their mean in the step."""
    before = load(state, row, lane)
    after = plus(before, 1.0, rise)
    store(state, row, lane, after)
    return after, dot(plus(before, 0.5, rise), q)
