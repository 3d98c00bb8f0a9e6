"""The Euler-Bernoulli beam by finite differences: rho A w_tt = M_xx + p, kappa = w_xx.

By symmetry only the half from the left support (node 0) to mid-span (node n) is solved; node
n + 1 of w mirrors node n - 1. w = M = 0 at the support. Deflection is positive downwards.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.kernels.jit import compiled, vectorised
from impactlab.kernels.section import Section, bend, plastic_energies
from impactlab.kernels.types import Array


class Beam(NamedTuple):
    """The half beam's state.

    w (m, n + 2), u = dt w_t at half steps (m, n + 1), M (N m, n + 1); each section's elastic
    interval M_0 (N m), kappa_min, kappa_max (1/m), n + 1 each; plastic_strain and peeq of its
    fibres, (n + 1, P // 2).
    """

    w: Array
    u: Array
    M: Array
    M_0: Array
    kappa_min: Array
    kappa_max: Array
    plastic_strain: Array
    peeq: Array


class Grid(NamedTuple):
    """n: index of mid-span; dx (m); dt (s); mu = rho A (kg/m).

    per_dx2 = 1/dx^2; factor = dt^2/(mu dx^2), from moments to w; push = dt^2/(mu dx), from the
    mid-span force to w.
    """

    n: int
    dx: float
    dt: float
    mu: float
    per_dx2: float
    factor: float
    push: float


_NOTHING = 1e-100
"""A deflection (m) ahead of the wave that counts as none: keeps denormal numbers out."""


@compiled
def make_grid(n: int, dx: float, dt: float, mu: float) -> Grid:
    """The grid and what follows from it."""
    return Grid(n, dx, dt, mu, 1.0 / dx**2, dt**2 / (mu * dx**2), dt**2 / (mu * dx))


@compiled
def make_beam(n: int, section: Section) -> Beam:
    """A beam at rest, nowhere yielded."""
    fibres = section.z.size
    return Beam(
        np.zeros(n + 2),
        np.zeros(n + 1),
        np.zeros(n + 1),
        np.zeros(n + 1),
        np.full(n + 1, -section.yield_curvature),
        np.full(n + 1, section.yield_curvature),
        np.zeros((n + 1, fibres)),
        np.zeros((n + 1, fibres)),
    )


@compiled
def reach(w: Array, first: int) -> int:
    """First node that the wave from mid-span has reached, one step after it had reached `first`."""
    moved = abs(w[first]) > _NOTHING or abs(w[first + 1]) > _NOTHING
    return max(first - 2, 1) if moved else first


# What follows runs at every step, so it takes arrays: handing on a whole Beam would count eight
# references up and down each time. The loops run from 0 over slices, because an index that might
# be negative would keep numba from vectorising them.


@vectorised
def virgin_moments(
    w: Array, M: Array, first: int, EI: float, kappa_y: float, per_dx2: float
) -> float:
    """Moments from node `first` on, of a beam never yielded; how many nodes now yield."""
    w, M = w[first - 1 :], M[first:]
    outside = 0.0
    for i in range(M.size):
        kappa = (w[i] - 2.0 * w[i + 1] + w[i + 2]) * per_dx2
        M[i] = -EI * kappa
        outside += 1.0 if abs(kappa) > kappa_y else 0.0
    return outside


@vectorised
def elastic_moments(
    w: Array,
    M: Array,
    M_0: Array,
    kappa_min: Array,
    kappa_max: Array,
    first: int,
    EI: float,
    per_dx2: float,
) -> float:
    """Moments from node `first` on, as if none yields now; how many nodes left their interval."""
    w, M, M_0 = w[first - 1 :], M[first:], M_0[first:]
    kappa_min, kappa_max = kappa_min[first:], kappa_max[first:]
    outside = 0.0
    for i in range(M.size):
        kappa = (w[i] - 2.0 * w[i + 1] + w[i + 2]) * per_dx2
        M[i] = M_0[i] - EI * kappa
        outside += 1.0 if kappa > kappa_max[i] else 0.0
        outside += 1.0 if kappa < kappa_min[i] else 0.0
    return outside


@compiled
def bend_yielding(
    w: Array,
    M: Array,
    M_0: Array,
    kappa_min: Array,
    kappa_max: Array,
    plastic_strain: Array,
    peeq: Array,
    z: Array,
    lever: Array,
    constants: tuple[float, float, float, float, float],
    outside: float,
    per_dx2: float,
) -> None:
    """Bend the sections that have left their elastic interval, `outside` in number.

    From mid-span outwards, where they most often are, until all are found. constants: E, S_y, H_i,
    H_k (Pa) and the stiffness (N m2) of the section.
    """
    E, S_y, H_i, H_k, EI = constants
    i = M.size
    while outside > 0.0 and i > 1:
        i -= 1
        kappa = (w[i - 1] - 2.0 * w[i] + w[i + 1]) * per_dx2
        if kappa > kappa_max[i] or kappa < kappa_min[i]:
            M_0[i], kappa_min[i], kappa_max[i] = bend(
                z, lever, E, S_y, H_i, H_k, kappa, plastic_strain, peeq, i
            )
            M[i] = M_0[i] - EI * kappa
            outside -= 1.0


@vectorised
def move(w: Array, u: Array, M: Array, first: int, factor: float, push: float) -> None:
    """One leapfrog step of w and u from node `first` on.

    factor: dt^2/(rho A dx^2). push: dt^2 F/(rho A dx), by the contact force at mid-span, in m.
    """
    n = M.size - 1
    w_, u_, M_ = w[first:n], u[first:n], M[first - 1 :]
    for i in range(u_.size):
        u_[i] += factor * (M_[i] - 2.0 * M_[i + 1] + M_[i + 2])
        w_[i] += u_[i]
    u[n] += 2.0 * factor * (M[n - 1] - M[n]) + push
    w[n] += u[n]
    w[n + 1] = w[n - 1]


@vectorised
def _kinetic_sum(u: Array, M: Array, factor: float) -> float:
    """Sum of u (m,) times its next value under the moments M (m + 2,)."""
    total = 0.0
    for i in range(u.size):
        total += u[i] * (u[i] + factor * (M[i] - 2.0 * M[i + 1] + M[i + 2]))
    return total


@compiled
def kinetic_energy(beam: Beam, grid: Grid, first: int, F: float) -> float:
    """Kinetic energy (J) of the whole beam at a full step.

    From the product of the velocities half a step before and after, which with the elastic
    energy is what leapfrog conserves exactly in a linear beam.
    """
    n, factor, push = grid.n, grid.factor, grid.push * F
    kick = 2.0 * factor * (beam.M[n - 1] - beam.M[n]) + push
    total = 2.0 * _kinetic_sum(beam.u[first:n], beam.M[first - 1 :], factor)
    total += beam.u[n] * (beam.u[n] + kick)
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@vectorised
def _bending_sum(M: Array, M_0: Array) -> float:
    total = 0.0
    for i in range(M.size):
        total += M[i] * M[i] - M_0[i] * M_0[i]
    return total


@compiled
def strain_energies(beam: Beam, section: Section, grid: Grid, first: int) -> tuple[float, float]:
    """(stored, dissipated) energy (J) of the whole beam.

    Per length, the elastic interval stores EI kappa^2/2 - M_0 kappa = (M^2 - M_0^2)/(2 EI) over
    what its plastic strains store at zero curvature.
    """
    n = grid.n
    bending = (
        2.0 * _bending_sum(beam.M[first:n], beam.M_0[first:n]) + beam.M[n] ** 2 - beam.M_0[n] ** 2
    )
    stored, dissipated = bending / (2.0 * section.stiffness), 0.0
    for i in range(first, n + 1):
        if beam.peeq[i, 0] > 0.0:  # the outermost fibre yields first
            times = 1.0 if i == n else 2.0
            kept, lost = plastic_energies(section, beam.plastic_strain[i], beam.peeq[i])
            stored += times * kept
            dissipated += times * lost
    return stored * grid.dx, dissipated * grid.dx
