"""The von Karman beam at rest after a strike: least elastic energy with the plastic strains held.

At rest the axial force N is the same everywhere, 0 unless both ends hold the axis, and under it the
deflection solves the linear equations

    (EI w_xx - M_0)_xx - N w_xx + k w = 0

of the grid, springs of ends included. All sections together are as long as the axis,

    g(N) = integral of (N - N_0)/EA - w_x^2/2 over the span = 0.

Above the buckling load, where the equations' matrix is positive definite, g grows with N: there is
one root, and it has the least energy of all equilibria. (With W = max over N of f(w, N), f convex
in w there, W(any w) >= f(any w, N) >= f(w(N), N) = W(w(N)).) Bisection finds it; the pivots of the
matrix, all positive or not, show on which side of the buckling load N lies.

A beam that is bowed by more than about its depth has a second equilibrium, bowed the other way. A
beam that swings through to that one while it comes to rest is not followed (P. S. Symonds and T. X.
Yu, J. Appl. Mech. 52 (1985) 517, recalled).
"""

import math

from impactlab.solver.beam import CLAMPED, PINNED, SPRUNG, SYMMETRIC, BeamGrid, is_end
from impactlab.solver.jit import compiled
from impactlab.solver.types import Array

_HALVINGS = 200
"""The most steps of bisection: until no number lies in between."""
_ABOVE_BUCKLING = 1.01
"""Of Rayleigh's bound of the buckling load, where the search begins."""


@compiled
def _assemble(bands: Array, M_0: Array, EI: float, N: float, bed: float, grid: BeamGrid) -> None:
    """Set the rows of the equations: diagonal, next and second next to it, and the load."""
    diagonal, beside, beyond, load = bands[0], bands[1], bands[2], bands[3]
    dx, bend, pull = grid.dx, EI / grid.dx**3, N / grid.dx
    for i in range(diagonal.size):
        diagonal[i] = beside[i] = beyond[i] = load[i] = 0.0
    for i in range(grid.first, grid.stop):
        diagonal[i - 1] += bend
        diagonal[i] += 4.0 * bend + dx * bed
        diagonal[i + 1] += bend
        beside[i - 1] -= 2.0 * bend
        beside[i] -= 2.0 * bend
        beyond[i - 1] += bend
        load[i - 1] += M_0[i] / dx
        load[i] -= 2.0 * M_0[i] / dx
        load[i + 1] += M_0[i] / dx
    for i in range(grid.first - 1, grid.stop):
        diagonal[i] += pull
        diagonal[i + 1] += pull
        beside[i] -= pull
    for kind, end, inside, turn, lift in (
        (grid.left, grid.first - 1, grid.first, grid.turn_left, grid.lift_left),
        (grid.right, grid.stop, grid.stop - 1, grid.turn_right, grid.lift_right),
    ):
        diagonal[end] += 0.5 * dx * bed
        share = 1.0 if kind in (CLAMPED, SYMMETRIC) else 0.0
        if kind == SPRUNG:
            share = turn
            diagonal[end] += 0.5 * lift * bend
        else:
            load[inside] += share * M_0[end] / dx
            load[end] -= share * M_0[end] / dx
        diagonal[end] += 2.0 * share * bend
        diagonal[inside] += 2.0 * share * bend
        beside[min(end, inside)] -= 2.0 * share * bend


@compiled
def _solve(w: Array, bands: Array, grid: BeamGrid) -> bool:
    """Set w (m), unless the matrix is not positive definite; return whether it is."""
    pivot, beside, beyond, load = bands[0], bands[1], bands[2], bands[3]
    low = grid.first if grid.left in (PINNED, CLAMPED) else grid.first - 1
    high = grid.stop - 1 if grid.right in (PINNED, CLAMPED) else grid.stop
    beside[low - 1] = beyond[low - 1] = beyond[low - 2] = 0.0
    beside[high] = beyond[high] = beyond[high - 1] = 0.0
    for i in range(low, high + 1):
        before, twice = beside[i - 1], beyond[i - 2]
        pivot[i] -= before * before * pivot[i - 1] + twice * twice * pivot[i - 2]
        if pivot[i] <= 0.0:
            return False
        load[i] -= before * load[i - 1] + twice * load[i - 2]
        beside[i] = (beside[i] - before * beyond[i - 1] * pivot[i - 1]) / pivot[i]
        beyond[i] /= pivot[i]
    for i in range(w.size):
        w[i] = 0.0
    for i in range(high, low - 1, -1):
        w[i] = load[i] / pivot[i] - beside[i] * w[i + 1] - beyond[i] * w[i + 2]
    return True


@compiled
def _arc(w: Array, grid: BeamGrid) -> float:
    """Return by how much the deflected axis is longer than the span, or than half of it (m)."""
    total = 0.0
    for i in range(grid.first - 1, grid.stop):
        total += (w[i + 1] - w[i]) ** 2
    return 0.5 * total / grid.dx


@compiled
def _buckling_bound(EI: float, bed: float, grid: BeamGrid) -> float:
    """Return a force (N) that buckles the beam: Rayleigh's quotient of 1 - cos(2 pi x/L)."""
    spacings = grid.stop - grid.first + 1
    span = grid.dx * (2 * spacings if grid.right == SYMMETRIC else spacings)
    wave = (2.0 * math.pi / span) ** 2
    return _ABOVE_BUCKLING * (EI * wave + 3.0 * bed / wave)


@compiled
def static_stretch(
    w: Array,
    bands: Array,
    M_0: Array,
    N_0: Array,
    EI: float,
    EA: float,
    bed: float,
    held: bool,
    grid: BeamGrid,
) -> float:
    """Set the deflection w (m) at rest; return the axial force N (N).

    bands: room, (4, last + 3). M_0 (N m), N_0 (N): see von_karman.py. bed: stiffness of the
    foundation (N/m2). held: whether both ends hold the axis.
    """
    _assemble(bands, M_0, EI, 0.0, bed, grid)
    _solve(w, bands, grid)
    if not held:
        return 0.0
    softness, longer = 0.0, 0.0
    for i in range(grid.first - 1, grid.stop + 1):
        share = (0.5 if is_end(grid, i) else 1.0) * grid.dx / EA
        softness += share
        longer -= share * N_0[i]
    longest = _arc(w, grid)
    low, high = 0.0, (longest - longer) / softness
    if high <= 0.0:  # sections too long for the beam without a force
        low, high = -_buckling_bound(EI, bed, grid), 0.0
        low = max(low, -longer / softness)
    for _ in range(_HALVINGS):
        N = 0.5 * (low + high)
        if not low < N < high:
            break
        _assemble(bands, M_0, EI, N, bed, grid)
        above = _solve(w, bands, grid) and softness * N + longer >= _arc(w, grid)
        low, high = (low, N) if above else (N, high)
    _assemble(bands, M_0, EI, high, bed, grid)
    _solve(w, bands, grid)
    return high


@compiled
def static_axis(
    u: Array, w: Array, N: float, N_0: Array, EA: float, held: tuple[bool, bool], grid: BeamGrid
) -> None:
    """Set the axial displacement u (m) at rest; held: the left end's axis, and the right one's."""
    first, stop, dx = grid.first - 1, grid.stop, grid.dx
    rise = w[first + 1] - w[first]
    u[first] = 0.5 * dx * (N - N_0[first]) / EA - 0.25 * rise * rise / dx if held[0] else 0.0
    for i in range(first + 1, stop):
        after = w[i + 1] - w[i]
        u[i] = u[i - 1] + dx * (N - N_0[i]) / EA - 0.25 * (rise * rise + after * after) / dx
        rise = after
    if held[0]:
        return
    shift = 0.0
    if held[1]:
        shift = 0.25 * rise * rise / dx - 0.5 * dx * (N - N_0[stop]) / EA - u[stop - 1]
    else:  # nothing has pushed the beam along
        for i in range(first, stop):
            shift -= u[i] / (stop - first)
    for i in range(first, stop):
        u[i] += shift
