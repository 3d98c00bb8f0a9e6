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

A beam that is bowed by more than about its depth has a second stable equilibrium, bowed the other
way. A beam that swings through to that one while it comes to rest is not followed (P. S. Symonds
and T. X. Yu, J. Appl. Mech. 52 (1985) 517, recalled), but remarked: below the buckling load the
axial force adds g'(N) < 0 to the stiffness, which makes up for one negative pivot and no more. g is
concave where there is one, so that its largest value tells whether such a root exists.

On a foundation the first buckling shape may be antisymmetric. Half a beam has no such shape: it may
come to rest where the whole one would buckle on, which is remarked, too.
"""

import math

from impactlab.solver.beam import CLAMPED, PINNED, SPRUNG, SYMMETRIC, BeamGrid, is_end
from impactlab.solver.jit import compiled
from impactlab.solver.outputs import SECOND_REST, UNSTABLE_REST
from impactlab.solver.settle import rest_nodes
from impactlab.solver.state import State
from impactlab.solver.types import Array

_HALVINGS = 200
"""The most steps of bisection: until no number lies in between."""
_ABOVE_BUCKLING = 1.01
"""Of Rayleigh's bound of the buckling load, where the search begins."""


@compiled
def _assemble(
    bands: Array, M_0: Array, EI: float, N: float, bed: float, grid: BeamGrid, right: int
) -> None:
    """Set the rows of the equations: diagonal, next and second next to it, and the load.

    right: kind of the right end.
    """
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
        (right, grid.stop, grid.stop - 1, grid.turn_right, grid.lift_right),
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
def _rows(grid: BeamGrid, right: int) -> tuple[int, int]:
    """Return the first and the last row of nodes that move; right: kind of the right end."""
    low = grid.first if grid.left in (PINNED, CLAMPED) else grid.first - 1
    return low, grid.stop - 1 if right in (PINNED, CLAMPED) else grid.stop


@compiled
def _factor(bands: Array, rows: tuple[int, int], most: int) -> int:
    """Factor the matrix and return its number of negative pivots, up to one more than `most`."""
    pivot, beside, beyond = bands[0], bands[1], bands[2]
    (low, high), negative = rows, 0
    beside[low - 1] = beyond[low - 1] = beyond[low - 2] = 0.0
    beside[high] = beyond[high] = beyond[high - 1] = 0.0
    for i in range(low, high + 1):
        before, twice = beside[i - 1], beyond[i - 2]
        pivot[i] -= before * before * pivot[i - 1] + twice * twice * pivot[i - 2]
        if pivot[i] <= 0.0:
            negative += 1
            if negative > most:
                break
        beside[i] = (beside[i] - before * beyond[i - 1] * pivot[i - 1]) / pivot[i]
        beyond[i] /= pivot[i]
    return negative


@compiled
def _substitute(w: Array, bands: Array, rows: tuple[int, int]) -> None:
    """Set w (m), the solution for the load."""
    pivot, beside, beyond, load = bands[0], bands[1], bands[2], bands[3]
    low, high = rows
    for i in range(low, high + 1):
        load[i] -= beside[i - 1] * load[i - 1] + beyond[i - 2] * load[i - 2]
    for i in range(w.size):
        w[i] = 0.0
    for i in range(high, low - 1, -1):
        w[i] = load[i] / pivot[i] - beside[i] * w[i + 1] - beyond[i] * w[i + 2]


@compiled
def _solve(w: Array, bands: Array, grid: BeamGrid) -> bool:
    """Set w (m), unless the matrix is not positive definite; return whether it is."""
    rows = _rows(grid, grid.right)
    definite = _factor(bands, rows, 0) == 0
    if definite:
        _substitute(w, bands, rows)
    return definite


@compiled
def _arc(w: Array, grid: BeamGrid) -> float:
    """Return by how much the deflected axis is longer than the span, or than half of it (m)."""
    total = 0.0
    for i in range(grid.first - 1, grid.stop):
        total += (w[i + 1] - w[i]) ** 2
    return 0.5 * total / grid.dx


@compiled
def _lengths(N_0: Array, EA: float, grid: BeamGrid) -> tuple[float, float]:
    """Return by how much a force of 1 N lengthens the beam (m/N), and by how much N_0 does (m)."""
    softness, longer = 0.0, 0.0
    for i in range(grid.first - 1, grid.stop + 1):
        share = (0.5 if is_end(grid, i) else 1.0) * grid.dx / EA
        softness += share
        longer -= share * N_0[i]
    return softness, longer


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
    _assemble(bands, M_0, EI, 0.0, bed, grid, grid.right)
    _solve(w, bands, grid)
    if not held:
        return 0.0
    softness, longer = _lengths(N_0, EA, grid)
    longest = _arc(w, grid)
    low, high = 0.0, (longest - longer) / softness
    if high <= 0.0:  # sections too long for the beam without a force
        low, high = -_buckling_bound(EI, bed, grid), 0.0
        low = max(low, -longer / softness)
    for _ in range(_HALVINGS):
        N = 0.5 * (low + high)
        if not low < N < high:
            break
        _assemble(bands, M_0, EI, N, bed, grid, grid.right)
        above = _solve(w, bands, grid) and softness * N + longer >= _arc(w, grid)
        low, high = (low, N) if above else (N, high)
    _assemble(bands, M_0, EI, high, bed, grid, grid.right)
    _solve(w, bands, grid)
    return high


@compiled
def _steepness(w: Array, bands: Array, grid: BeamGrid) -> float:
    """Return what deflection adds to g'(N) (m/N), after a solution for w; w, load: overwritten."""
    load, rows = bands[3], _rows(grid, grid.right)
    for i in range(rows[0], rows[1] + 1):
        ahead = w[i + 1] - w[i] if i < grid.stop else 0.0
        behind = w[i] - w[i - 1] if i >= grid.first else 0.0
        load[i] = bands[4, i] = (behind - ahead) / grid.dx
    _substitute(w, bands, rows)
    total = 0.0
    for i in range(rows[0], rows[1] + 1):
        total += bands[4, i] * w[i]
    return total


@compiled
def _turns(bands: Array, M_0: Array, EI: float, N: float, bed: float, grid: BeamGrid) -> bool:
    """Return whether N (N) buckles half a beam into an antisymmetric shape, its middle pinned."""
    _assemble(bands, M_0, EI, N, bed, grid, PINNED)
    return _factor(bands, _rows(grid, PINNED), 0) > 0


@compiled
def has_second_rest(
    w: Array,
    bands: Array,
    M_0: Array,
    N_0: Array,
    EI: float,
    EA: float,
    bed: float,
    grid: BeamGrid,
) -> bool:
    """Return whether a beam with held ends has a second stable shape, its plastic strains held.

    w: room, (last + 3). bands: room, (5, last + 3). The others: see static_stretch. Half a beam
    must not buckle into an antisymmetric shape there.
    """
    softness, longer = _lengths(N_0, EA, grid)
    low, high = -longer / softness, 0.0
    if low >= high:
        return False
    rows = _rows(grid, grid.right)
    _assemble(bands, M_0, EI, low, bed, grid, grid.right)
    if _factor(bands, rows, 0) == 0:  # no force below the buckling load is possible
        return False
    for _ in range(_HALVINGS):
        N = 0.5 * (low + high)
        if not low < N < high:
            break
        turned = grid.right == SYMMETRIC and _turns(bands, M_0, EI, N, bed, grid)
        _assemble(bands, M_0, EI, N, bed, grid, grid.right)
        negative = _factor(bands, rows, 1)
        if negative == 0:
            high = N
        elif negative > 1 or turned:
            low = N
        else:
            _substitute(w, bands, rows)
            if softness * N + longer >= _arc(w, grid):
                return True
            rises = softness + _steepness(w, bands, grid) > 0.0
            low, high = (N, high) if rises else (low, N)
    return False


@compiled
def rest_remarks(state: State) -> int:
    """Return the bits of remarks on the shape in which a beam was put to rest."""
    _, section, grid, beam, plastic, stretch = state
    if not (stretch.held[0] and stretch.held[1]):
        return 0
    EI, EA, bed = section.stiffness, stretch.stiffness, stretch.resistance.bed
    bed *= grid.mu / grid.dt**2
    w, bands = beam.w[1], stretch.bands
    M_0, remarks, N = plastic.M_0, 0, stretch.N[grid.mid]
    if has_second_rest(w, bands, M_0, stretch.N_0, EI, EA, bed, grid):
        remarks = SECOND_REST
    if grid.right == SYMMETRIC and _turns(bands, M_0, EI, N, bed, grid):
        remarks |= UNSTABLE_REST
    rest_nodes(beam, grid)
    return remarks


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
