"""The Euler-Bernoulli beam by finite differences: rho A w_tt = M_xx + p, kappa = w_xx.

Deflection is positive downwards. By symmetry only the half from the left support to mid-span is
solved. Arrays along it have n + 4 entries: 1 is the support, where w = M = 0, `mid` = n + 1 is
mid-span, which is struck, and 0, mid + 1, mid + 2 mirror the nodes within.

That a half is solved, and the strike at its end, is known here alone: make_grid places the nodes,
COPIES and copies() are the factors of works and energies, mirror() and its kin set what lies beyond
the ends, and half_node() finds the nodes of a profile of the whole beam. Another place of the
strike, or other supports (fields of the model's classes with one value each), would change these;
the loops, which end at `mid`, would end at a last node of the grid's own; and the modal scheme,
whose modes are the symmetric ones of pinned ends (modes.py), and the static shape of lumped.py
would need others.

With M = M_0 - EI kappa (section.py), M_xx is the fourth difference of w and the second one of
M_0. M_0 changes only where sections yield, so a step is one loop over w, and the share of M_0 in
it, `plastic`, is kept from step to step.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from impactlab.solver.jit import allocating, compiled, inlined, vectorised
from impactlab.solver.types import ONE, TWO, Array, Index


class BeamState(NamedTuple):
    """The half beam's state.

    w: deflection (m) at this step and the next, in turns, (2, n + 4). u = dt w_t at half steps, du
    its increment (of the other beam models alone), plastic = dt^2/(rho A) (M_0)_xx, all in m,
    (n + 4,).
    """

    w: Array
    u: Array
    du: Array
    plastic: Array


class BeamGrid(NamedTuple):
    """mid: index of mid-span, the struck node; dx (m); dt (s); mu = rho A (kg/m).

    per_dx2 = 1/dx^2. Shares in w of one step: factor = dt^2/(mu dx^2) of a second difference of
    moments, stiffness = factor EI/dx^2 of a fourth difference of w, push = dt^2/(mu dx) of the
    mid-span force.
    """

    mid: int
    dx: float
    dt: float
    mu: float
    per_dx2: float
    factor: float
    stiffness: float
    push: float


COPIES = 2.0
"""Nodes of the whole beam that a node of the half stands for; mid-span is its own mirror image."""
_NOTHING = 1e-100
"""A deflection (m) ahead of the wave that counts as none: keeps denormal numbers out."""


@compiled
def half_spacings(nodes: int) -> int:
    """Return how many spacings are solved of a beam with so many nodes."""
    return nodes // 2


@compiled
def make_grid(nodes: int, dx: float, dt: float, mu: float, EI: float) -> BeamGrid:
    """Return the grid of a beam with so many nodes, and what follows from it."""
    mid, factor = half_spacings(nodes) + 1, dt**2 / (mu * dx**2)
    return BeamGrid(mid, dx, dt, mu, 1.0 / dx**2, factor, factor * EI / dx**2, dt**2 / (mu * dx))


@compiled
def copies(grid: BeamGrid, i: Index) -> float:
    """Return how many nodes of the whole beam node i stands for."""
    return 1.0 if i == grid.mid else COPIES


@compiled
def half_node(grid: BeamGrid, i: int) -> int:
    """Return which node stands for the whole beam's node i, counted from 0 at the left support."""
    return min(i, 2 * (grid.mid - 1) - i) + 1


@allocating
def make_beam(grid: BeamGrid) -> BeamState:
    """Return a beam at rest that has yielded nowhere."""
    size = grid.mid + 3
    return BeamState(np.zeros((2, size)), np.zeros(size), np.zeros(size), np.zeros(size))


@compiled
def rest_beam(beam: BeamState) -> None:
    """Put a beam back to rest."""
    for i in range(beam.u.size):
        beam.w[0, i] = beam.w[1, i] = beam.u[i] = beam.du[i] = beam.plastic[i] = 0.0


@compiled
def reach(w: Array, now: int, first: int) -> int:
    """Return where the wave from mid-span begins, one step after it began at `first`."""
    moved = abs(w[now, first]) > _NOTHING or abs(w[now, first + 1]) > _NOTHING
    return max(first - 2, 2) if moved else first


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
    grid: BeamGrid,
) -> float:
    """Move the nodes from `first` to mid-span by one step, without yielding further or a force.

    Returns the number of sections that are now outside their elastic interval (1/m).
    """
    after, outside = 1 - now, 0.0
    for i in range(np.uint64(first), np.uint64(grid.mid + 1)):
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
    u[grid.mid] += grid.push * F
    w[1 - now, grid.mid] += grid.push * F
    mirror(w, now, grid)


@compiled
def mirror(w: Array, now: int, grid: BeamGrid) -> None:
    """Set the nodes beyond both ends after a step: w is odd at the support, even at mid-span."""
    after, mid = 1 - now, grid.mid
    w[after, 0] = -w[after, 2]
    w[after, mid + 1] = w[after, mid - 1]
    w[after, mid + 2] = w[after, mid - 2]


@inlined
def mirror_even(field: Array, mid: int) -> None:
    """Set the node beyond mid-span of a field that is even there."""
    field[mid + 1] = field[mid - 1]


@inlined
def mirror_halfway(field: Array, mid: int) -> None:
    """Set the value beyond mid-span of an odd field, half-way from node i to i + 1 at index i."""
    field[mid] = -field[mid - 1]


@compiled
def add_moment(plastic: Array, M_0: Array, i: Index, change: Any, grid: BeamGrid) -> None:
    """Change M_0 of section i by so much (N m), and `plastic` with it."""
    share = grid.factor * change
    M_0[i] += change
    plastic[i - ONE] += share  # at the support it is never read
    plastic[i] -= 2.0 * share
    # mid-span has such a neighbour on both sides
    plastic[i + ONE] += COPIES * share if i + ONE == np.uint64(grid.mid) else share


# The energy at a full step, once u has been moved on.


@compiled
def kinetic_energy(beam: BeamState, grid: BeamGrid, now: int, u_mid: float) -> float:
    """Return the kinetic energy in J, from the product of velocities half a step before and after.

    With the elastic energy it is what leapfrog conserves exactly in a linear beam. u_mid (m): u at
    mid-span before.
    """
    total = _kinetic_sum(beam.w, now, beam.u, beam.plastic, grid, u_mid)
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@vectorised
def _kinetic_sum(
    w: Array, now: int, u: Array, plastic: Array, grid: BeamGrid, u_mid: float
) -> float:
    half = 0.0
    for i in range(np.uint64(2), np.uint64(grid.mid)):
        beside = w[now, i - ONE] + w[now, i + ONE]
        fourth = w[now, i - TWO] + w[now, i + TWO] - 4.0 * beside + 6.0 * w[now, i]
        half += u[i] * (u[i] - plastic[i] + grid.stiffness * fourth)
    return COPIES * half + u[grid.mid] * u_mid


@compiled
def bending_energy(beam: BeamState, M_0: Array, EI: float, grid: BeamGrid, now: int) -> float:
    """Return the energy stored in J above what plastic strains store at zero curvature.

    Within the elastic interval, EI kappa^2/2 - M_0 kappa per length.
    """
    return grid.dx * _bending_sum(beam.w, now, M_0, EI, grid)


@vectorised
def _bending_sum(w: Array, now: int, M_0: Array, EI: float, grid: BeamGrid) -> float:
    half, mid = 0.0, grid.mid
    for i in range(np.uint64(2), np.uint64(mid)):
        kappa = (w[now, i - ONE] - 2.0 * w[now, i] + w[now, i + ONE]) * grid.per_dx2
        half += kappa * (0.5 * EI * kappa - M_0[i])
    kappa = 2.0 * (w[now, mid - 1] - w[now, mid]) * grid.per_dx2
    return COPIES * half + kappa * (0.5 * EI * kappa - M_0[mid])
