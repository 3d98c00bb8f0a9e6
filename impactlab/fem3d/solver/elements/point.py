"""One integration point: its rows in `state`, and what a step's motion makes of them."""

from __future__ import annotations

from impactlab.fem3d.solver.elements.lanes import W
from impactlab.fem3d.solver.elements.vectors import Tensor
from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.material.motion import deviatoric_rate, spin, turned
from impactlab.fem3d.solver.material.plasticity import Metal, Six, less, radial_return
from impactlab.fem3d.solver.types import Array

STRESS, BACK, PEEQ, ALONG = 0, 6, 12, 13
"""Rows from a point's first: deviator, back stress, PEEQ, plastic strain along the beam."""
ROWS = 14
"""Rows of a point."""


@inlined
def advance(
    state: Array, row: int, lane: int, L: Tensor, dt: float, metal: Metal
) -> tuple[Six, float, float]:
    """The deviator (Pa) at the step's end; the work on it and what of it is dissipated, in J/m3.

    L: dv/dx at the middle of the step, in 1/s. row: the point's first in `state`, which is updated.
    """
    rate, turn = deviatoric_rate(L), spin(L, dt)
    before = turned(_load(state, row + STRESS, lane), turn)
    back = turned(_load(state, row + BACK, lane), turn)
    p = state[(row + PEEQ) * W + lane]
    trial = less(before, -2.0 * metal[2] * dt, rate)
    S, back, dp, along = radial_return(trial, back, p, metal)
    _store(state, row + STRESS, lane, S)
    _store(state, row + BACK, lane, back)
    state[(row + PEEQ) * W + lane] = p + dp
    state[(row + ALONG) * W + lane] += along
    work = 0.5 * dt * _double_dot(less(before, -1.0, S), rate)
    return S, work, dp * (metal[4] + metal[5] * (p + 0.5 * dp))


@inlined
def _load(state: Array, row: int, lane: int) -> Six:
    at = row * W + lane
    return (
        state[at],
        state[at + W],
        state[at + 2 * W],
        state[at + 3 * W],
        state[at + 4 * W],
        state[at + 5 * W],
    )


@inlined
def _store(state: Array, row: int, lane: int, s: Six) -> None:
    at = row * W + lane
    state[at], state[at + W], state[at + 2 * W] = s[0], s[1], s[2]
    state[at + 3 * W], state[at + 4 * W], state[at + 5 * W] = s[3], s[4], s[5]


@inlined
def _double_dot(a: Six, b: Six) -> float:
    shear = a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * shear
