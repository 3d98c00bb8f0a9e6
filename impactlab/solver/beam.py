"""The Euler-Bernoulli beam by finite differences: rho A w_tt = M_xx + p, kappa = w_xx.

Deflection is positive downwards. The nodes from 2 to `last` are moved, `mid` among them is the
struck one, and arrays have last + 3 entries: two nodes beyond either end set the conditions there
(mirror()). A pinned end (w = M = 0) lies on the first node beyond, so that no moved node does
without its neighbours; a clamped one (w = w_x = 0) on the last moved node, which is put back and
whose section bends; a free one (M = Q = 0) there, too, with half a spacing's mass. An elastic one
is a free one with springs against deflection and rotation; half a spacing beside it stays elastic,
in series with the spring. These conditions make the energies below sums over the nodes, of which an
end has half its share.

A beam of equal ends that is struck in its middle is solved from the left end to mid-span: another
kind of end, symmetric, where w is even. That a half is solved is known here alone: to make_grid, to
`copies` of the grid and copies(), the factors of works and energies, and to half_node(), which
finds the nodes of a profile of the whole beam. The modal scheme and lumped beams know pinned
halves alone (model/case_table.py refuses others).

With M = M_0 - EI kappa (section.py), M_xx is the fourth difference of w and the second one of
M_0. M_0 changes only where sections yield, so a step is one loop over w, and the share of M_0 in
it, `plastic`, is kept from step to step.
"""

from typing import Any, NamedTuple

import numpy as np

from impactlab.solver import SUPPORTS
from impactlab.solver.jit import allocating, compiled, summing, vectorised
from impactlab.solver.types import ONE, TWO, Array, Index


class BeamState(NamedTuple):
    """The state of the nodes.

    w: deflection (m) at this step and the next, in turns, (2, last + 3). u = dt w_t at half steps,
    du its increment (of the other beam models alone), plastic = dt^2/(rho A) (M_0)_xx, all in m,
    (last + 3,).
    """

    w: Array
    u: Array
    du: Array
    plastic: Array


class BeamGrid(NamedTuple):
    """mid: index of the struck node; dx (m); dt (s); mu = rho A (kg/m).

    per_dx2 = 1/dx^2. Shares in w of one step: factor = dt^2/(mu dx^2) of a second difference of
    moments, stiffness = factor EI/dx^2 of a fourth difference of w, push = dt^2/(mu dx) of a
    force. last: index of the last node moved; first, stop: those from first to before stop are no
    ends. left, right: kinds of the ends. copies: number of nodes of the whole beam that such a node
    stands for. Of elastic ends: turn = k_r/(k_r + 2 EI/dx) of the spring against rotation, lift =
    2 k_t dx^3/EI of that against deflection.
    """

    mid: int
    dx: float
    dt: float
    mu: float
    per_dx2: float
    factor: float
    stiffness: float
    push: float
    last: int
    first: int
    stop: int
    left: int
    right: int
    copies: float
    turn_left: float
    turn_right: float
    lift_left: float
    lift_right: float


PINNED, CLAMPED, FREE, SPRUNG = (SUPPORTS.index(name) for name in SUPPORTS[:4])
SYMMETRIC = len(SUPPORTS)
"""Kinds of ends; symmetric is mid-span, where a half beam ends."""
COPIES = 2.0
"""Nodes of the whole beam that a node of the half stands for; mid-span is its own mirror image."""
_NOTHING = 1e-100
"""A deflection (m) ahead of the wave that counts as none: keeps denormal numbers out."""


@compiled
def half_spacings(nodes: int) -> int:
    """Return how many spacings are solved of a beam with so many nodes."""
    return nodes // 2


@compiled
def make_grid(
    nodes: int,
    dx: float,
    dt: float,
    mu: float,
    EI: float,
    left: int = PINNED,
    right: int = PINNED,
    struck: int = -1,
    k_left: float = 0.0,
    k_right: float = 0.0,
    turn_left: float = 0.0,
    turn_right: float = 0.0,
    alike: bool = True,
) -> BeamGrid:
    """Return the grid of a beam with so many nodes, and what follows from it.

    struck: the node that is, counted from 0 at the left end; -1: the middle one. k_left, k_right
    (N/m), turn_left, turn_right (N m): springs of elastic ends against deflection and rotation.
    alike: whether equal ends make a symmetric beam.
    """
    middle = half_spacings(nodes)
    struck = middle if struck < 0 else struck
    halved = alike and left == right and struck == middle and 2 * middle == nodes - 1
    if left == SPRUNG:
        halved = halved and k_left == k_right and turn_left == turn_right
    start = 1 if left == PINNED else 2  # index of the left end
    right = SYMMETRIC if halved else right
    end = start + (middle if halved else nodes - 1)
    last = end - 1 if right == PINNED else end
    factor = dt**2 / (mu * dx**2)
    lift = 2.0 * dx**3 / EI
    return BeamGrid(
        start + struck,
        dx,
        dt,
        mu,
        1.0 / dx**2,
        factor,
        factor * EI / dx**2,
        dt**2 / (mu * dx),
        last,
        start + 1,
        end,
        left,
        right,
        COPIES if halved else 1.0,
        turn_left / (turn_left + 2.0 * EI / dx),
        turn_right / (turn_right + 2.0 * EI / dx),
        lift * k_left,
        lift * k_right,
    )


@compiled
def is_end(grid: BeamGrid, i: Index) -> bool:
    """Return whether node i is an end, or lies beyond one: it has half a spacing."""
    return bool(i < grid.first or i >= grid.stop)


@compiled
def copies(grid: BeamGrid, i: Index) -> float:
    """Return how many spacings of the whole beam node i stands for."""
    return 0.5 * grid.copies if is_end(grid, i) else grid.copies


@compiled
def half_node(grid: BeamGrid, i: int) -> int:
    """Return which node stands for the whole beam's node i, counted from 0 at the left support."""
    node = grid.first - 1 + i
    return min(node, 2 * grid.mid - node) if grid.right == SYMMETRIC else node


@allocating
def make_beam(grid: BeamGrid) -> BeamState:
    """Return a beam at rest that has yielded nowhere."""
    size = grid.last + 3
    return BeamState(np.zeros((2, size)), np.zeros(size), np.zeros(size), np.zeros(size))


@compiled
def rest_beam(beam: BeamState) -> None:
    """Put a beam back to rest."""
    for i in range(beam.u.size):
        beam.w[0, i] = beam.w[1, i] = beam.u[i] = beam.du[i] = beam.plastic[i] = 0.0


@compiled
def reach(w: Array, now: int, first: int) -> int:
    """Return where the wave from the struck node begins, one step after it began at `first`."""
    moved = abs(w[now, first]) > _NOTHING or abs(w[now, first + 1]) > _NOTHING
    return max(first - 2, 2) if moved else first


@compiled
def reach_right(w: Array, now: int, end: int, last: int) -> int:
    """Return where the wave ends, as `reach` where it begins; last: of the nodes."""
    moved = abs(w[now, end]) > _NOTHING or abs(w[now, end - 1]) > _NOTHING
    return min(end + 2, last) if moved else end


# What follows runs at every step, so it takes arrays: a whole BeamState takes longer to hand on.


@vectorised
def move_virgin(
    w: Array, now: int, u: Array, first: int, stop: int, grid: BeamGrid, kappa_y: float
) -> float:
    """Move the nodes from `first` to before `stop`, where nothing has yielded yet, by one step.

    Returns the number of sections that are now beyond the yield curvature kappa_y (1/m).
    """
    after, outside = 1 - now, 0.0
    for i in range(np.uint64(first), np.uint64(stop)):
        w_i, beside = w[now, i], w[now, i - ONE] + w[now, i + ONE]
        outside += 1.0 if abs((beside - 2.0 * w_i) * grid.per_dx2) > kappa_y else 0.0
        u[i] -= grid.stiffness * (w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w_i)
        w[after, i] = w_i + u[i]
    return outside


@vectorised
def move(
    w: Array,
    now: int,
    u: Array,
    plastic: Array,
    kappa_min: Array,
    kappa_max: Array,
    first: int,
    stop: int,
    grid: BeamGrid,
) -> float:
    """Move the nodes from `first` to before `stop` by one step, without a force or more yielding.

    Returns the number of sections that are now outside their elastic interval (1/m).
    """
    after, outside = 1 - now, 0.0
    for i in range(np.uint64(first), np.uint64(stop)):
        w_i, beside = w[now, i], w[now, i - ONE] + w[now, i + ONE]
        kappa = (beside - 2.0 * w_i) * grid.per_dx2
        outside += 1.0 if kappa > kappa_max[i] else 0.0
        outside += 1.0 if kappa < kappa_min[i] else 0.0
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w_i
        u[i] += plastic[i] - grid.stiffness * fourth
        w[after, i] = w_i + u[i]
    return outside


@compiled
def strike(w: Array, now: int, u: Array, F: float, grid: BeamGrid) -> None:
    """Add the contact force F (N) to a step already made, and mirror the nodes beyond the ends."""
    change = grid.push * F
    if copies(grid, grid.mid) < 1.0:  # a free end
        change *= 2.0
    u[grid.mid] += change
    w[1 - now, grid.mid] += change
    mirror(w, now, u, grid)


@compiled
def push_nodes(
    beam: BeamState, grid: BeamGrid, now: int, nodes: Array, forces: Array, share: float
) -> None:
    """Add a share of the forces (N) on nodes of the whole beam to a step already made."""
    for k in range(nodes.size):
        if forces[k] != 0.0:
            i = nodes[k]
            change = share * grid.push * forces[k] / copies(grid, i)
            beam.u[i] += change
            beam.du[i] += change
            beam.w[1 - now, i] += change
    mirror(beam.w, now, beam.u, grid)


@compiled
def mirror(w: Array, now: int, u: Array, grid: BeamGrid) -> None:
    """Set the nodes at and beyond both ends after a step."""
    after, last = 1 - now, grid.last
    if grid.left == PINNED:
        w[after, 0] = -w[after, 2]
    else:
        _set_end(w[after], u, 2, 1, grid.left, grid.turn_left, grid.lift_left)
    if grid.right == SYMMETRIC:
        w[after, last + 1] = w[after, last - 1]
        w[after, last + 2] = w[after, last - 2]
    elif grid.right == PINNED:
        w[after, last + 2] = -w[after, last]
    else:
        _set_end(w[after], u, last, -1, grid.right, grid.turn_right, grid.lift_right)


@compiled
def _set_end(
    w: Array, u: Array, end: int, inward: int, kind: int, turn: float, lift: float
) -> None:
    """Set the nodes at and beyond an end that is not pinned; inward: 1 or -1.

    Clamped, w is even about it. Free, the moment is zero there and even about it; then the moment's
    second difference is that of a node with half the mass. Elastic, the moment is the spring's, and
    the outer node adds the force of the other.
    """
    beside, inside = w[end + inward], w[end + 2 * inward]
    if kind == CLAMPED:
        w[end] = u[end] = 0.0
        w[end - inward], w[end - 2 * inward] = beside, inside
    elif kind == SPRUNG:
        beyond = 2.0 * (w[end] - beside) + 2.0 * turn * (beside - w[end])
        w[end - inward] = beside + beyond
        w[end - 2 * inward] = inside + 2.0 * beyond + lift * w[end]
    else:
        w[end - inward] = 2.0 * w[end] - beside
        w[end - 2 * inward] = 4.0 * (w[end] - beside) + inside


@compiled
def add_moment(plastic: Array, M_0: Array, i: Index, change: Any, grid: BeamGrid) -> None:
    """Change M_0 of section i by so much (N m), and `plastic` with it."""
    share = grid.factor * change
    M_0[i] += change
    # mid-span has such a neighbour on both sides, a free end half the mass; others never read it
    plastic[i - ONE] += 2.0 * share if i - ONE < np.uint64(grid.first) else share
    plastic[i] -= 2.0 * share
    plastic[i + ONE] += 2.0 * share if i + ONE >= np.uint64(grid.stop) else share


# The energy at a full step, once u has been moved on.


@compiled
def kinetic_energy(beam: BeamState, grid: BeamGrid, now: int, u_mid: float) -> float:
    """Return the kinetic energy in J, from the product of velocities half a step before and after.

    With the elastic energy it is what leapfrog conserves exactly in a linear beam. u_mid (m): u of
    the struck node before.
    """
    w, u, plastic, mid = beam.w, beam.u, beam.plastic, grid.mid
    struck = (0.5 if is_end(grid, mid) else 1.0) * u_mid
    total = _kinetic_sum(w, now, u, plastic, grid, grid.first, min(grid.stop, mid), struck)
    for start, stop, share in (
        (2, min(grid.first, mid), 0.5),
        (max(grid.first, mid + 1), grid.stop, 1.0),
        (max(grid.stop, mid + 1), grid.last + 1, 0.5),
    ):  # one end, the other side of the struck node, the other end
        if start < stop:
            total += share * _kinetic_sum(w, now, u, plastic, grid, start, stop, 0.0)
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@summing
def _kinetic_sum(
    w: Array,
    now: int,
    u: Array,
    plastic: Array,
    grid: BeamGrid,
    start: int,
    stop: int,
    u_mid: float,
) -> float:
    """Return the sum of the nodes from start to before stop; u_mid: 0 without the struck one."""
    total = 0.0
    for i in range(np.uint64(start), np.uint64(stop)):
        beside = w[now, i - ONE] + w[now, i + ONE]
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w[now, i]
        total += u[i] * (u[i] - plastic[i] + grid.stiffness * fourth)
    if grid.right == SYMMETRIC:
        total, u_mid = COPIES * total, COPIES * u_mid
    return total + u[grid.mid] * u_mid


@compiled
def bending_energy(beam: BeamState, M_0: Array, EI: float, grid: BeamGrid, now: int) -> float:
    """Return the energy stored in J above what plastic strains store at zero curvature.

    Within the elastic interval, EI kappa^2/2 - M_0 kappa per length.
    """
    return grid.dx * _bending_sum(beam.w, now, M_0, EI, grid)


@compiled
def end_springs(w: float, beside: float, turn: float, lift: float) -> float:
    """Return the energy of an elastic end's springs, over EI/(2 dx^3), in m2."""
    return 0.5 * lift * w * w + 2.0 * turn * (beside - w) * (beside - w)


@summing
def _bending_sum(w: Array, now: int, M_0: Array, EI: float, grid: BeamGrid) -> float:
    total, share, last = 0.0, 0.5, grid.last
    for i in range(np.uint64(grid.first), np.uint64(grid.stop)):
        kappa = (w[now, i - ONE] - 2.0 * w[now, i] + w[now, i + ONE]) * grid.per_dx2
        total += kappa * (0.5 * EI * kappa - M_0[i])
    if grid.right == SYMMETRIC:
        total, share = COPIES * total, 0.5 * COPIES
    if grid.left == SPRUNG:
        springs = end_springs(w[now, 2], w[now, 3], grid.turn_left, grid.lift_left)
        total += share * EI * grid.per_dx2 * grid.per_dx2 * springs
    if grid.right == SPRUNG:
        springs = end_springs(w[now, last], w[now, last - 1], grid.turn_right, grid.lift_right)
        total += share * EI * grid.per_dx2 * grid.per_dx2 * springs
    if grid.left == CLAMPED:
        kappa = 2.0 * w[now, 3] * grid.per_dx2
        total += share * kappa * (0.5 * EI * kappa - M_0[2])
    if grid.right == CLAMPED or grid.right == SYMMETRIC:
        kappa = 2.0 * (w[now, last - 1] - w[now, last]) * grid.per_dx2
        total += share * kappa * (0.5 * EI * kappa - M_0[last])
    return total
