"""Leapfrog made stable for any time step: the beam's acceleration is filtered.

(I + beta dt^2 K) a = (M_xx + p)/(rho A), K = (EI)_q/(rho A) d^4/dx^4, with the moments M of this
step, plastic ones included, and the contact force on the right: central differences with an
increment solved for. It is Newmark's average acceleration for beta = 1/4 and a linear beam; a
larger beta keeps perfectly plastic sections from chattering between +M_p and -M_p. Beam's bending
then sets no limit to the time step, the contact still does.

Source: N. M. Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67, with the forces that are not linear
taken at the beginning of the step (Hughes, Pister, Taylor, Comput. Methods Appl. Mech. Eng. 17/18
(1979) 159).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import Beam, Grid, mirror
from impactlab.solver.fibre_plasticity import (
    PlasticState,
    begin_tangents,
    follow_tangents,
    leave_tangents,
)
from impactlab.solver.jit import allocating, compiled, ordered, vectorised
from impactlab.solver.section import Section
from impactlab.solver.types import ONE, TWO, Array

BETA = 0.5
"""Weight of the filter."""


class Filter(NamedTuple):
    """I + alpha^2 (fourth difference) over the half beam, factorised from both ends at once.

    alpha2 = beta dt^2 (EI)_q/(rho A dx^4). Rows `first` to mid (indices as in beam.py) are two
    chains of `length` rows, from the support and from mid-span inwards, and two rows s, t between
    them. below, beyond, inverse: L[k, k - 1], L[k, k - 2] and 1/D[k] of each chain in the order of
    elimination, (length + 2, 2). by_s, by_t: the chains' answer to a unit in rows s and t,
    (n + 4,). between: the inverse of what then is left for s and t: its entries ss, st, tt.
    """

    alpha2: float
    first: int
    length: int
    below: Array
    beyond: Array
    inverse: Array
    by_s: Array
    by_t: Array
    between: tuple[float, float, float]


@allocating
def make_filter(grid: Grid, EI: float) -> Filter:
    """Return the factors, for a half beam of at least 8 spacings."""
    alpha2 = BETA * grid.dt**2 * EI / (grid.mu * grid.dx**4)
    first = 1 + grid.mid % 2  # makes the rows even in number; that of the support is zero
    length = (grid.mid - first - 1) // 2
    below, beyond, inverse = _factorise(alpha2, first, length)
    by_s, by_t = np.zeros(grid.mid + 3), np.zeros(grid.mid + 3)
    s, t = first + length, first + length + 1
    by_s[s - 2], by_s[s - 1], by_s[t + 1] = alpha2, -4.0 * alpha2, alpha2
    by_t[s - 1], by_t[t + 1], by_t[t + 2] = alpha2, -4.0 * alpha2, alpha2
    _solve_chains(by_s, below, beyond, inverse, first, length, grid.mid)
    _solve_chains(by_t, below, beyond, inverse, first, length, grid.mid)
    ss = 1.0 + alpha2 * (6.0 - by_s[s - 2] + 4.0 * by_s[s - 1] - by_s[t + 1])
    st = alpha2 * (-4.0 - by_t[s - 2] + 4.0 * by_t[s - 1] - by_t[t + 1])
    tt = 1.0 + alpha2 * (6.0 - by_t[s - 1] + 4.0 * by_t[t + 1] - by_t[t + 2])
    determinant = ss * tt - st * st
    between = (tt / determinant, -st / determinant, ss / determinant)
    return Filter(alpha2, first, length, below, beyond, inverse, by_s, by_t, between)


@allocating
def no_filter() -> Filter:
    """Return the filter of an explicit run, which has no rows."""
    rows, none = np.zeros((0, 2)), np.zeros(0)
    return Filter(0.0, 0, 0, rows, rows, rows, none, none, (0.0, 0.0, 0.0))


@allocating
def _factorise(alpha2: float, first: int, length: int) -> tuple[Array, Array, Array]:
    """Return L D L^T of both chains: (below, beyond, inverse), see Filter."""
    below, beyond = np.zeros((length + 2, 2)), np.zeros((length + 2, 2))
    inverse, pivot = np.zeros((length + 2, 2)), np.zeros((length, 2))
    for side in range(2):
        for k in range(length):
            row, next_row, row_after = _row(alpha2, k, side == 0, first == 1)
            if k > 1:
                beyond[k, side] = row_after / pivot[k - 2, side]
                next_row -= row_after * below[k - 1, side]
                row -= row_after * beyond[k, side]
            if k > 0:
                below[k, side] = next_row / pivot[k - 1, side]
                row -= next_row * below[k, side]
            pivot[k, side] = row
            inverse[k, side] = 1.0 / row
    return below, beyond, inverse


@compiled
def _row(alpha2: float, k: int, from_support: bool, filled: bool) -> tuple[float, float, float]:
    """Return (A[k, k], A[k, k - 1], A[k, k - 2]) of row k of a chain.

    At the support w is odd; at mid-span it is even, and the row halved to keep A symmetric.
    filled: the first row from the support is the support itself, which nothing is tied to.
    """
    if from_support:
        node = k if filled else k + 1  # 0 is the support
        if node == 0:
            return 1.0, 0.0, 0.0
        own = 5.0 if node == 1 else 6.0
        return 1.0 + own * alpha2, -4.0 * alpha2 * (node > 1), alpha2 * (node > 2)
    if k == 0:
        return 0.5 * (1.0 + 6.0 * alpha2), 0.0, 0.0
    own = 7.0 if k == 1 else 6.0
    return 1.0 + own * alpha2, -4.0 * alpha2, alpha2


@ordered
def _solve_chains(
    x: Array, below: Array, beyond: Array, inverse: Array, first: int, length: int, mid: int
) -> None:
    """Solve both chains, as if nothing were between them, in place of their right-hand sides.

    The two at once: each waits for its last result, and the other fills the time.
    """
    y_1, y_2, z_1, z_2 = 0.0, 0.0, 0.0, 0.0
    i, j = np.uint64(first), np.uint64(mid)
    for k in range(length):
        y = (x[i] - beyond[k, 0] * y_2) - below[k, 0] * y_1
        z = (x[j] - beyond[k, 1] * z_2) - below[k, 1] * z_1
        x[i], x[j] = y, z
        y_2, y_1, z_2, z_1 = y_1, y, z_1, z
        i += ONE
        j -= ONE
    y_1, y_2, z_1, z_2 = 0.0, 0.0, 0.0, 0.0
    for k in range(length - 1, -1, -1):
        i -= ONE
        j += ONE
        y = (x[i] * inverse[k, 0] - beyond[k + 2, 0] * y_2) - below[k + 1, 0] * y_1
        z = (x[j] * inverse[k, 1] - beyond[k + 2, 1] * z_2) - below[k + 1, 1] * z_1
        x[i], x[j] = y, z
        y_2, y_1, z_2, z_1 = y_1, y, z_1, z


@compiled
def solve(x: Array, filter: Filter, grid: Grid) -> None:
    """Put the solution in the place of the right-hand side, but for what add_between adds."""
    x[grid.mid] *= 0.5  # that row is halved
    s, t = filter.first + filter.length, filter.first + filter.length + 1
    _solve_chains(
        x, filter.below, filter.beyond, filter.inverse, filter.first, filter.length, grid.mid
    )
    left_s = x[s] - filter.alpha2 * (x[s - 2] - 4.0 * x[s - 1] + x[t + 1])
    left_t = x[t] - filter.alpha2 * (x[s - 1] - 4.0 * x[t + 1] + x[t + 2])
    ss, st, tt = filter.between
    x[s], x[t] = ss * left_s + st * left_t, st * left_s + tt * left_t


@vectorised
def pull(
    w: Array,
    now: int,
    du: Array,
    plastic: Array,
    kappa_min: Array,
    kappa_max: Array,
    grid: Grid,
) -> float:
    """Set du to the increment of an explicit step; return the sections outside (see move)."""
    outside = 0.0
    for i in range(np.uint64(2), np.uint64(grid.mid + 1)):
        here, beside = w[now, i], w[now, i - ONE] + w[now, i + ONE]
        kappa = (beside - 2.0 * here) * grid.per_dx2
        outside += 1.0 if kappa > kappa_max[i] else 0.0
        outside += 1.0 if kappa < kappa_min[i] else 0.0
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * here
        du[i] = plastic[i] - grid.stiffness * fourth
    return outside


@vectorised
def advance(
    w: Array, now: int, u: Array, du: Array, by_s: Array, by_t: Array, s: int, grid: Grid
) -> None:
    """Complete the solution du with the rows s and s + 1, and move u and w by it."""
    after, x_s, x_t = 1 - now, du[s], du[s + 1]
    for i in range(np.uint64(2), np.uint64(grid.mid + 1)):
        du[i] -= by_s[i] * x_s + by_t[i] * x_t
        u[i] += du[i]
        w[after, i] = w[now, i] + u[i]


@compiled
def filtered_step(
    beam: Beam,
    plastic_state: PlasticState,
    section: Section,
    grid: Grid,
    filter: Filter,
    now: int,
    F: float,
) -> None:
    """Move the beam by one step under the contact force F (N)."""
    w, u, du = beam.w, beam.u, beam.du
    if plastic_state.on_tangent[0] > 0 and follow_tangents(
        beam.w,
        now,
        du[:0],
        beam.plastic,
        plastic_state.M_0,
        plastic_state.on_tangent,
        plastic_state.tangent,
        grid,
    ):
        leave_tangents(beam, now, du[:0], plastic_state, section, grid)
    outside = pull(w, now, du, beam.plastic, plastic_state.kappa_min, plastic_state.kappa_max, grid)
    if outside > 0.0:
        begin_tangents(beam, now, du[:0], outside, plastic_state, section, grid, du, du[:0])
    du[grid.mid] += grid.push * F
    solve(du, filter, grid)
    advance(w, now, u, du, filter.by_s, filter.by_t, filter.first + filter.length, grid)
    mirror(w, now, grid)


@compiled
def filtered_kinetic_energy(beam: Beam, grid: Grid, filter: Filter, now: int, F: float) -> float:
    """Return the kinetic energy in J: rho A dx/2 v_before^T (I + beta dt^2 K) v_after.

    With the elastic energy the scheme conserves it exactly in a linear beam.
    """
    total = _filtered_sum(
        beam.w, now, beam.u, beam.du, beam.plastic, grid, filter.alpha2, grid.push * F
    )
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@vectorised
def _filtered_sum(
    w: Array,
    now: int,
    u: Array,
    du: Array,
    plastic: Array,
    grid: Grid,
    alpha2: float,
    push: float,
) -> float:
    half, mid = 0.0, grid.mid
    for i in range(np.uint64(2), np.uint64(mid)):
        beside = w[now, i - ONE] + w[now, i + ONE]
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w[now, i]
        v = u[i] - du[i]
        bend = (u[i - ONE] - du[i - ONE]) + (u[i + ONE] - du[i + ONE]) - 2.0 * v
        half += v * (v + plastic[i] - grid.stiffness * fourth) + alpha2 * bend * bend
    fourth = 2.0 * w[now, mid - 2] - 8.0 * w[now, mid - 1] + 6.0 * w[now, mid]
    v = u[mid] - du[mid]
    bend = 2.0 * (u[mid - 1] - du[mid - 1] - v)
    pulled = plastic[mid] - grid.stiffness * fourth + push
    return 2.0 * half + v * (v + pulled) + alpha2 * bend * bend
