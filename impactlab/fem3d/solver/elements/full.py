"""The hexahedron with eight integration points and mean dilatation (B-bar).

Each point has its own deviator; the dilatation, and with it the mean stress, is one for the whole
element, so that plastic flow, which keeps its volume, does not lock.
Source: J. C. Nagtegaal, D. M. Parks and J. R. Rice, Comput. Methods Appl. Mech. Engng. 4 (1974)
153; T. J. R. Hughes, Int. J. Numer. Meth. Engng. 15 (1980) 1413.
"""

from __future__ import annotations

import math

from impactlab.fem3d.solver.elements.hexahedron import (
    F,
    Shape,
    Tensor,
    V,
    Vector,
    W,
    X,
    add,
    apply,
    combine,
    cross,
    dot,
    gather,
    gradient,
    mean_gradient,
    midway,
    nodal,
    plus,
    scatter,
    shape,
    times,
    volume,
)
from impactlab.fem3d.solver.jit import Array, compiled, inlined
from impactlab.fem3d.solver.material import POINT_ROWS, Metal, advance

POINTS = 8
"""Integration points, whose rows come first in `state`."""
MEAN, WORK, DISSIPATED, HOURGLASS_WORK = (8 * POINT_ROWS + n for n in range(4))
"""Rows of the mean stress (Pa) and of energies (J); the last stays 0."""
ROWS = 8 * POINT_ROWS + 4
"""Rows of `state`."""

_C, _W, _T = F + 24, F + 45, F + 66
"""First rows in `s` of the modes of position and velocity, and of the modes' forces, 21 each."""
_ROOT = 1.0 / math.sqrt(3.0)


@compiled
def full_forces(
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
    """Do the same as one_point_forces, with eight points."""
    for block in range(blocks[0], blocks[1]):
        gather(s, nodes[block], x, v)
        held = state[block]
        for lane in range(W):
            _begin(s, held, lane, dt, metal)
        for corner in range(8):
            xi = _ROOT * (2 * (corner & 1) - 1)
            eta = _ROOT * ((corner & 2) - 1)
            zeta = _ROOT * ((corner >> 1 & 2) - 1)
            for lane in range(W):
                _point(s, held, corner * POINT_ROWS, lane, (xi, eta, zeta), dt, metal)
        for lane in range(W):
            nodal(s, lane, _load(s, _T, lane))
        scatter(s, rows[block], forces)


@inlined
def _begin(s: Array, state: Array, lane: int, dt: float, metal: Metal) -> None:
    """Store the modes of the motion in `s`; update the mean stress, its work and its forces."""
    c, w = shape(s, X, lane), shape(s, V, lane)
    _store(s, _C, lane, c)
    _store(s, _W, lane, w)
    B = gradient(c)
    size = volume(c, B)
    L = midway(mean_gradient(w, B, size), dt)
    dilation = dt * (L[0][0] + L[1][1] + L[2][2])
    before = state[MEAN * W + lane]
    mean = before + metal[3] * dilation
    state[MEAN * W + lane] = mean
    state[WORK * W + lane] += size * 0.5 * (before + mean) * dilation
    eighth = 0.125 * mean
    forces = (
        times(eighth, B[0]),
        times(eighth, B[1]),
        times(eighth, B[2]),
        times(eighth, B[3]),
        times(eighth, B[4]),
        times(eighth, B[5]),
        (0.0, 0.0, 0.0),
    )
    _store(s, _T, lane, forces)


@inlined
def _point(
    s: Array, state: Array, row: int, lane: int, at: Vector, dt: float, metal: Metal
) -> None:
    """Update an integration point's deviator and its work; add its share to the modes' forces."""
    r, v = _slopes(_load(s, _C, lane), at), _slopes(_load(s, _W, lane), at)
    C1, C2, C3 = cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1])
    size = dot(r[0], C1)
    L = midway(_velocity_gradient(v, (C1, C2, C3), 1.0 / size), dt)
    S, work, dissipated = advance(state, row, lane, L, dt, metal)
    state[WORK * W + lane] += size * work
    state[DISSIPATED * W + lane] += size * dissipated
    T = ((S[0], S[5], S[4]), (S[5], S[1], S[3]), (S[4], S[3], S[2]))
    _add(
        s,
        lane,
        at,
        times(0.125, apply(T, C1)),
        times(0.125, apply(T, C2)),
        times(0.125, apply(T, C3)),
    )


@inlined
def _slopes(c: Shape, at: Vector) -> Tensor:
    """Return derivatives by xi, eta and zeta, at a point."""
    xi, eta, zeta = at
    c1, c2, c3, g1, g2, g3, g4 = c
    return (
        plus(plus(plus(c1, zeta, g2), eta, g3), eta * zeta, g4),
        plus(plus(plus(c2, zeta, g1), xi, g3), zeta * xi, g4),
        plus(plus(plus(c3, eta, g1), xi, g2), xi * eta, g4),
    )


@inlined
def _velocity_gradient(v: Tensor, C: Tensor, share: float) -> Tensor:
    """Return dv_i/dx_j by rows, from dv/dxi and the cofactors of dx/dxi."""
    return (
        times(share, combine(C, (v[0][0], v[1][0], v[2][0]))),
        times(share, combine(C, (v[0][1], v[1][1], v[2][1]))),
        times(share, combine(C, (v[0][2], v[1][2], v[2][2]))),
    )


@inlined
def _add(s: Array, lane: int, at: Vector, t1: Vector, t2: Vector, t3: Vector) -> None:
    """Add forces that work on derivatives by xi, eta and zeta to those of the modes."""
    xi, eta, zeta = at
    f1, f2, f3, f4, f5, f6, f7 = _load(s, _T, lane)
    forces = (
        add(f1, t1),
        add(f2, t2),
        add(f3, t3),
        plus(plus(f4, zeta, t2), eta, t3),
        plus(plus(f5, zeta, t1), xi, t3),
        plus(plus(f6, eta, t1), xi, t2),
        plus(plus(plus(f7, eta * zeta, t1), zeta * xi, t2), xi * eta, t3),
    )
    _store(s, _T, lane, forces)


@inlined
def _load(s: Array, row: int, lane: int) -> Shape:
    """Return seven vectors, of rows row, row + 1, ..."""
    at = row * W + lane
    return (
        _vector(s, at),
        _vector(s, at + 3 * W),
        _vector(s, at + 6 * W),
        _vector(s, at + 9 * W),
        _vector(s, at + 12 * W),
        _vector(s, at + 15 * W),
        _vector(s, at + 18 * W),
    )


@inlined
def _vector(s: Array, at: int) -> Vector:
    return (s[at], s[at + W], s[at + 2 * W])


@inlined
def _store(s: Array, row: int, lane: int, f: Shape) -> None:
    at = row * W + lane
    _put(s, at, f[0])
    _put(s, at + 3 * W, f[1])
    _put(s, at + 6 * W, f[2])
    _put(s, at + 9 * W, f[3])
    _put(s, at + 12 * W, f[4])
    _put(s, at + 15 * W, f[5])
    _put(s, at + 18 * W, f[6])


@inlined
def _put(s: Array, at: int, a: Vector) -> None:
    s[at], s[at + W], s[at + 2 * W] = a[0], a[1], a[2]
