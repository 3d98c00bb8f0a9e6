"""The Euler-Bernoulli beam by finite differences: rho A w_tt = M_xx + p, kappa = w_xx.

By symmetry only the half from the left support (node 0) to mid-span (node n) is solved; node
n + 1 of w mirrors node n - 1. w = M = 0 at the support. Deflection is positive downwards.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np

from impactlab.kernels.jit import compiled, vectorised
from impactlab.kernels.section import bend, plastic_energies

Beam = namedtuple("Beam", "w u M M_0 kappa_min kappa_max plastic_strain peeq")
"""The half beam's state. w (m, n + 2), u = dt w_t at half steps (m, n + 1), M (N m, n + 1);
each section's elastic interval M_0 (N m), kappa_min, kappa_max (1/m), n + 1 each; plastic_strain
and peeq of its fibres, (n + 1, P // 2)."""

Grid = namedtuple("Grid", "n dx dt mu")
"""n: index of mid-span; dx (m); dt (s); mu = rho A (kg/m)."""

_BLOCK = 64
_NOTHING = 1e-100
"""A deflection (m) ahead of the wave that counts as none: keeps denormal numbers out."""


@compiled
def make_beam(n, section):
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
def reach(beam, first):
    """First node that the wave from mid-span has reached, one step after it had reached `first`."""
    moved = abs(beam.w[first]) > _NOTHING or abs(beam.w[first + 1]) > _NOTHING
    return max(first - 2, 1) if moved else first


# The loops below run from 0 over slices: an index that might be negative would keep numba from
# vectorising them.


@vectorised
def _virgin(w, M, EI, kappa_y, per_dx2):
    """Moments M (m,) of a beam that has never yielded, from w (m + 2,); how many nodes now do."""
    outside = 0.0
    for i in range(M.size):
        kappa = (w[i] - 2.0 * w[i + 1] + w[i + 2]) * per_dx2
        M[i] = -EI * kappa
        outside += 1.0 if abs(kappa) > kappa_y else 0.0
    return outside


@vectorised
def _elastic_block(w, M, M_0, kappa_min, kappa_max, EI, per_dx2):
    """Elastic moments M (m,), from w (m + 2,); how many nodes have left their interval."""
    outside = 0.0
    for i in range(M.size):
        kappa = (w[i] - 2.0 * w[i + 1] + w[i + 2]) * per_dx2
        M[i] = M_0[i] - EI * kappa
        outside += 1.0 if kappa > kappa_max[i] or kappa < kappa_min[i] else 0.0
    return outside


@compiled
def _plastic_block(beam, section, start, stop, per_dx2):
    """Bend those of the nodes start <= i < stop that have left their elastic interval."""
    w = beam.w
    for i in range(start, stop):
        kappa = (w[i - 1] - 2.0 * w[i] + w[i + 1]) * per_dx2
        if kappa > beam.kappa_max[i] or kappa < beam.kappa_min[i]:
            beam.M_0[i], beam.kappa_min[i], beam.kappa_max[i] = bend(
                section, kappa, beam.plastic_strain[i], beam.peeq[i]
            )
            beam.M[i] = beam.M_0[i] - section.stiffness * kappa


@compiled
def bend_beam(beam, section, grid, first, yielded):
    """Moments at all nodes from `first` on; whether the beam has ever yielded."""
    per_dx2 = 1.0 / grid.dx**2
    if not yielded:
        w, M, kappa_y = beam.w[first - 1 :], beam.M[first:], section.yield_curvature
        if _virgin(w, M, section.stiffness, kappa_y, per_dx2) == 0.0:
            return False
    for start in range(first, grid.n + 1, _BLOCK):
        stop = min(start + _BLOCK, grid.n + 1)
        outside = _elastic_block(
            beam.w[start - 1 : stop + 1],
            beam.M[start:stop],
            beam.M_0[start:stop],
            beam.kappa_min[start:stop],
            beam.kappa_max[start:stop],
            section.stiffness,
            per_dx2,
        )
        if outside > 0.0:
            _plastic_block(beam, section, start, stop, per_dx2)
    return True


@vectorised
def _move(w, u, M, factor):
    """Step w and u (m,) under the moments M (m + 2,)."""
    for i in range(u.size):
        u[i] += factor * (M[i] - 2.0 * M[i + 1] + M[i + 2])
        w[i] += u[i]


@compiled
def move_beam(beam, grid, first, F):
    """One leapfrog step of w and u under the moments and the mid-span force F (N)."""
    n = grid.n
    factor = grid.dt**2 / (grid.mu * grid.dx**2)
    _move(beam.w[first:n], beam.u[first:n], beam.M[first - 1 :], factor)
    beam.u[n] += 2.0 * factor * (beam.M[n - 1] - beam.M[n]) + grid.dt**2 * F / (grid.mu * grid.dx)
    beam.w[n] += beam.u[n]
    beam.w[n + 1] = beam.w[n - 1]


@vectorised
def _kinetic_sum(u, M, factor):
    """Sum of u (m,) times its next value under the moments M (m + 2,)."""
    total = 0.0
    for i in range(u.size):
        total += u[i] * (u[i] + factor * (M[i] - 2.0 * M[i + 1] + M[i + 2]))
    return total


@compiled
def kinetic_energy(beam, grid, first, F):
    """Kinetic energy (J) of the whole beam at a full step.

    From the product of the velocities half a step before and after, which with the elastic
    energy is what leapfrog conserves exactly in a linear beam.
    """
    n = grid.n
    factor = grid.dt**2 / (grid.mu * grid.dx**2)
    kick = 2.0 * factor * (beam.M[n - 1] - beam.M[n]) + grid.dt**2 * F / (grid.mu * grid.dx)
    total = 2.0 * _kinetic_sum(beam.u[first:n], beam.M[first - 1 :], factor)
    total += beam.u[n] * (beam.u[n] + kick)
    return 0.5 * grid.mu * grid.dx / grid.dt**2 * total


@vectorised
def _bending_sum(M, M_0):
    total = 0.0
    for i in range(M.size):
        total += M[i] * M[i] - M_0[i] * M_0[i]
    return total


@compiled
def strain_energies(beam, section, grid, first):
    """(stored, dissipated) energy (J) of the whole beam.

    Per length, the elastic interval stores EI kappa^2/2 - M_0 kappa = (M^2 - M_0^2)/(2 EI) over
    what its plastic strains store at zero curvature.
    """
    n = grid.n
    bending = 2.0 * _bending_sum(beam.M[first:n], beam.M_0[first:n]) + beam.M[n] ** 2 - beam.M_0[n] ** 2
    stored, dissipated = bending / (2.0 * section.stiffness), 0.0
    for i in range(first, n + 1):
        if beam.peeq[i, 0] > 0.0:  # the outermost fibre yields first
            times = 1.0 if i == n else 2.0
            kept, lost = plastic_energies(section, beam.plastic_strain[i], beam.peeq[i])
            stored += times * kept
            dissipated += times * lost
    return stored * grid.dx, dissipated * grid.dx
