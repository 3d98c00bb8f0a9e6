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
    for mode in range(6):
        store(s, _T + 3 * mode, lane, times(0.125 * mean, B[mode]))
    store(s, _T + 18, lane, (0.0, 0.0, 0.0))


@inlined
def _point(
    s: Array, state: Array, row: int, lane: int, at: Vector, dt: float, metal: Metal
) -> None:
    """Update an integration point's deviator and its work; add its share to the modes' forces."""
    xi, eta, zeta = at
    r, v = _slopes(_load(s, _C, lane), at), _slopes(_load(s, _W, lane), at)
    C = (cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1]))  # cofactors of dx/dxi
    size = dot(r[0], C[0])
    share = 1.0 / size
    gradient = (
        times(share, combine(C, (v[0][0], v[1][0], v[2][0]))),
        times(share, combine(C, (v[0][1], v[1][1], v[2][1]))),
        times(share, combine(C, (v[0][2], v[1][2], v[2][2]))),
    )
    S, work, dissipated = advance(state, row, lane, midway(gradient, dt), dt, metal)
    state[WORK * W + lane] += size * work
    state[DISSIPATED * W + lane] += size * dissipated
    T = ((S[0], S[5], S[4]), (S[5], S[1], S[3]), (S[4], S[3], S[2]))
    # Forces that work on the derivatives by xi, eta and zeta, and those of the modes.
    t1, t2 = times(0.125, apply(T, C[0])), times(0.125, apply(T, C[1]))
    t3 = times(0.125, apply(T, C[2]))
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
def _load(s: Array, row: int, lane: int) -> Shape:
    """Return the seven vectors in rows from `row` on."""
    return (
        load(s, row, lane),
        load(s, row + 3, lane),
        load(s, row + 6, lane),
        load(s, row + 9, lane),
        load(s, row + 12, lane),
        load(s, row + 15, lane),
        load(s, row + 18, lane),
    )


@inlined
def _store(s: Array, row: int, lane: int, f: Shape) -> None:
    for mode in range(7):
        store(s, row + 3 * mode, lane, f[mode])
