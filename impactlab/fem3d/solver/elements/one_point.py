"""The hexahedron with one integration point: mean strain, and stiffness against hourglassing."""

from __future__ import annotations

from impactlab.fem3d.solver.elements import hourglass as against
from impactlab.fem3d.solver.elements import point
from impactlab.fem3d.solver.elements.geometry import (
    Gradient,
    gradient,
    mean_gradient,
    midway,
    volume,
)
from impactlab.fem3d.solver.elements.hourglass import Four, hourglass
from impactlab.fem3d.solver.elements.lanes import V, W, X, gather, scatter
from impactlab.fem3d.solver.elements.modes import Shape, shape
from impactlab.fem3d.solver.elements.nodal import nodal
from impactlab.fem3d.solver.elements.point import advance
from impactlab.fem3d.solver.elements.vectors import Tensor, Vector, apply, combine, plus, times
from impactlab.fem3d.solver.jit import compiled, inlined
from impactlab.fem3d.solver.material.plasticity import Metal, Six
from impactlab.fem3d.solver.types import Array

POINTS = 1
"""Integration points, whose rows come first in `state`."""
MEAN, WORK, DISSIPATED, HOURGLASS_WORK = (point.ROWS + n for n in range(4))
"""Rows of the mean stress (Pa) and of energies (J)."""
_Q = point.ROWS + 4
ROWS = _Q + against.ROWS
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
        held = state[block]
        for lane in range(W):
            _element(s, held, lane, dt, metal)
        scatter(s, rows[block], forces)


@inlined
def _element(s: Array, state: Array, lane: int, dt: float, metal: Metal) -> None:
    c, w = shape(s, X, lane), shape(s, V, lane)
    B = gradient(c)
    size = volume(c, B)
    L = mean_gradient(w, B, size)
    Q, work = hourglass(state, _Q, lane, c, w, L, size, dt, metal)
    state[HOURGLASS_WORK * W + lane] += work
    S, mean = _stress(state, lane, midway(L, dt), size, dt, metal)
    nodal(s, lane, _answer(c, B, S, mean, Q, 1.0 / size))


@inlined
def _stress(
    state: Array, lane: int, L: Tensor, size: float, dt: float, metal: Metal
) -> tuple[Six, float]:
    """Deviator and mean of the stress (Pa) at the step's end; energies are counted."""
    S, work, dissipated = advance(state, 0, lane, L, dt, metal)
    dilation = dt * (L[0][0] + L[1][1] + L[2][2])
    before = state[MEAN * W + lane]
    mean = before + metal[3] * dilation
    state[MEAN * W + lane] = mean
    state[WORK * W + lane] += size * (work + 0.5 * (before + mean) * dilation)
    state[DISSIPATED * W + lane] += size * dissipated
    return S, mean


@inlined
def _answer(c: Shape, B: Gradient, S: Six, mean: float, Q: Four, share: float) -> Shape:
    """The modes' forces (N), an eighth included; share: 1/volume."""
    Q1, Q2, Q3, Q4 = Q
    g = (c[3], c[4], c[5], c[6])
    T = (
        _row((S[0] + mean, S[5], S[4]), g, (Q1[0], Q2[0], Q3[0], Q4[0]), share),
        _row((S[5], S[1] + mean, S[3]), g, (Q1[1], Q2[1], Q3[1], Q4[1]), share),
        _row((S[4], S[3], S[2] + mean), g, (Q1[2], Q2[2], Q3[2], Q4[2]), share),
    )
    return (
        times(0.125, apply(T, B[0])),
        times(0.125, apply(T, B[1])),
        times(0.125, apply(T, B[2])),
        times(0.125, plus(apply(T, B[3]), 1.0, Q[0])),
        times(0.125, plus(apply(T, B[4]), 1.0, Q[1])),
        times(0.125, plus(apply(T, B[5]), 1.0, Q[2])),
        times(0.125, Q[3]),
    )


@inlined
def _row(stress: Vector, g: Four, Q: tuple[float, float, float, float], share: float) -> Vector:
    """A row of the stress, less what the hourglass forces take up of the mean gradient."""
    taken = combine((g[0], g[1], g[2]), (Q[0], Q[1], Q[2]))
    return plus(stress, -share, plus(taken, Q[3], g[3]))
