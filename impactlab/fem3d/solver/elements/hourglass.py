"""Physical stiffness of the one-point hexahedron against hourglassing.

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

from impactlab.fem3d.solver.elements.lanes import W
from impactlab.fem3d.solver.elements.modes import Shape
from impactlab.fem3d.solver.elements.vectors import (
    Tensor,
    Vector,
    apply,
    combine,
    cross,
    dot,
    plus,
    times,
)
from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.material.plasticity import Metal
from impactlab.fem3d.solver.types import Array

ROWS = 12
"""Hourglass forces in N, in the element's frame: three of a = 1, three of a = 2, ..."""

Four = tuple[Vector, Vector, Vector, Vector]


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
    """The four hourglass forces (N) at a step's end, and their work (J) in it.

    L: dv/dx at the step's end. row: the first in `state` of the forces, which are updated.
    """
    e = _frame(c)
    half = (dot(e[0], c[0]), dot(e[1], c[1]), dot(e[2], c[2]))
    q1, q2 = _rate(e, c[3], w[3], L), _rate(e, c[4], w[4], L)
    q3, q4 = _rate(e, c[5], w[5], L), _rate(e, c[6], w[6], L)
    p1, p2, p3, p4 = _stiffness((q1, q2, q3, q4), half, V * dt, metal)
    Q1, one = _load(state, row, lane, p1, q1)
    Q2, two = _load(state, row + 3, lane, p2, q2)
    Q3, three = _load(state, row + 6, lane, p3, q3)
    Q4, four = _load(state, row + 9, lane, p4, q4)
    work = dt * ((one + two) + (three + four))
    return (combine(e, Q1), combine(e, Q2), combine(e, Q3), combine(e, Q4)), work


@inlined
def _frame(c: Shape) -> Tensor:
    """Unit vectors: along c_1, in the plane of c_1 and c_2, across it."""
    along = times(1.0 / math.sqrt(dot(c[0], c[0])), c[0])
    across = cross(c[0], c[1])
    across = times(1.0 / math.sqrt(dot(across, across)), across)
    return (along, cross(across, along), across)


@inlined
def _rate(e: Tensor, g: Vector, h: Vector, L: Tensor) -> Vector:
    """h - L g in the frame, in m/s."""
    return apply(e, plus(h, -1.0, apply(L, g)))


@inlined
def _stiffness(q: Four, half: Vector, V: float, metal: Metal) -> Four:
    """Forces that answer hourglass motions q: the means over the brick of stress times strain."""
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
    """Stresses of two normal strains that vary alike, free of stress in the third direction."""
    return plate * (one + nu * other), plate * (other + nu * one)


@inlined
def _load(state: Array, row: int, lane: int, rise: Vector, q: Vector) -> tuple[Vector, float]:
    """Three forces after their rise, kept; and the power of their mean in the step."""
    at = row * W + lane
    before = (state[at], state[at + W], state[at + 2 * W])
    after = plus(before, 1.0, rise)
    state[at], state[at + W], state[at + 2 * W] = after[0], after[1], after[2]
    return after, dot(plus(before, 0.5, rise), q)
