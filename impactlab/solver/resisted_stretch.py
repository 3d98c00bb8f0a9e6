"""The von Karman beam with Rayleigh's damping, on Winkler's foundation.

Beside the forces of von_karman.py and -k w, the masses are damped by alpha rho A times both
velocities, and every spring by beta times its rate: with N_d = beta EA e_t and M_d = -beta EI
kappa_t,

    rho A u_tt + alpha rho A u_t = (N + N_d)_x,
    rho A w_tt + alpha rho A w_t = (M + M_d)_xx + ((N + N_d) w_x)_x - k (w + beta w_t) + p.

The strains' rates are those of large deflections, so that rigid motion is not damped by beta; for
small ones this is Rayleigh's damping of Euler-Bernoulli's beam. Steps and the work of damping are
those of resisted_pair.py.
"""

import numpy as np

from impactlab.solver.beam import CLAMPED, SPRUNG, SYMMETRIC, BeamGrid
from impactlab.solver.jit import compiled, vectorised
from impactlab.solver.resisted_pair import PairResistance
from impactlab.solver.types import ONE, Array


@vectorised
def _strain(
    w: Array, now: int, u: Array, v: Array, EA: float, resistance: PairResistance, grid: BeamGrid
) -> None:
    """Set axial force and moment of the last steps u and v, but for the ends'."""
    N, M, EI, per_dx = resistance.force, resistance.moment, resistance.EI, 1.0 / grid.dx
    for i in range(np.uint64(grid.first), np.uint64(grid.stop)):
        turned, turned_after = (u[i] - u[i - ONE]) * per_dx, (u[i + ONE] - u[i]) * per_dx
        stretched = (w[now, i] - w[now, i - ONE]) * turned
        stretched += (w[now, i + ONE] - w[now, i]) * turned_after
        N[i] = EA * per_dx * (v[i] - v[i - ONE] + 0.5 * stretched)
        M[i] = -EI * per_dx * (turned_after - turned)


@compiled
def _strain_ends(
    w: Array,
    now: int,
    u: Array,
    v: Array,
    EA: float,
    held: tuple[bool, bool],
    resistance: PairResistance,
    grid: BeamGrid,
) -> None:
    """Set axial force and moment of the last steps at the ends, and the moment beyond them."""
    N, M, EI, dx = resistance.force, resistance.moment, resistance.EI, grid.dx
    for kind, end, inward, half, turn, lift, holds in (
        (grid.left, grid.first - 1, 1, grid.first - 1, grid.turn_left, grid.lift_left, held[0]),
        (grid.right, grid.stop, -1, grid.stop - 1, grid.turn_right, grid.lift_right, held[1]),
    ):
        turned = (u[end + inward] - u[end]) / dx
        stretched = 2.0 * inward * v[half] + (w[now, end + inward] - w[now, end]) * turned
        N[end] = EA * stretched / dx if holds else 0.0
        share = 1.0 if kind in (CLAMPED, SYMMETRIC) else 0.0
        share = turn if kind == SPRUNG else share
        M[end] = -2.0 * EI * share * turned / dx
        spring = lift if kind == SPRUNG else 0.0
        M[end - inward] = M[end + inward] - spring * EI / dx**2 * u[end]


@vectorised
def _drag(
    w: Array,
    now: int,
    u: Array,
    P: Array,
    resistance: PairResistance,
    grid: BeamGrid,
    start: int,
    stop: int,
) -> None:
    """Set what the stiffness's damping takes; start, stop: the ends."""
    N, M, lag, per_dx = resistance.force, resistance.moment, resistance.lag, 1.0 / grid.dx
    for i in range(np.uint64(start), np.uint64(stop)):
        P[i] = 0.5 * (N[i] + N[i + ONE]) * (w[now, i + ONE] - w[now, i]) * per_dx
        resistance.other_drag[i] = -lag * grid.push * (N[i + ONE] - N[i])
    P[start - 1], P[stop] = -P[start], -P[stop - 1]
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        bent = (M[i - ONE] - 2.0 * M[i] + M[i + ONE]) * per_dx
        pushed = grid.push * (bent + P[i] - P[i - ONE])
        resistance.drag[i] = lag * (resistance.bed * u[i] - pushed)


@compiled
def drag_stretch(
    w: Array,
    now: int,
    u: Array,
    v: Array,
    P: Array,
    EA: float,
    held: tuple[bool, bool],
    resistance: PairResistance,
    grid: BeamGrid,
) -> None:
    """Set what the stiffness's damping takes from the steps u and v (m) before.

    P: room. held: whether the axis is held at the left end and at the right one.
    """
    _strain(w, now, u, v, EA, resistance, grid)
    _strain_ends(w, now, u, v, EA, held, resistance, grid)
    _drag(w, now, u, P, resistance, grid, grid.first - 1, grid.stop)
