"""The sine modes of a half beam: what a run keeps of them, and the loops over them.

The scheme's equations are in modal.py; see there for D, and for the last entry, which stands for
all modes left out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import BeamGrid
from impactlab.solver.flight import Leaps, make_leaps, rest_leaps
from impactlab.solver.jit import allocating, compiled, fused, summing, vectorised
from impactlab.solver.types import Array


class Modes(NamedTuple):
    """The modes of a run, n of them, and the sum of those left out in entry n.

    q: amplitude (m). u: dt dq/dt half a step before (m). k2: k_p^2 (1/m2). D: see modal.py. push:
    D/K (m/N). source (N): sum over the nodes of M_0 times the mode's curvature. Each (n + 1,).
    bent: curvature of node i per amplitude, (n + 4, n + 1), 1/m2; nodes as in beam.py. seen: q when
    all sections were last looked at, (n + 1,). near: the number of sections that could yield before
    the next such look, then which they are, (n + 1,). slack: what the curvature of any other may
    have changed by until that look, and can have changed by now (1/m), (2,). cosine: of quarter
    turns over n, (4 n,). leaps: see flight.py.
    """

    q: Array
    u: Array
    k2: Array
    D: Array
    push: Array
    source: Array
    bent: Array
    seen: Array
    near: Array
    slack: Array
    cosine: Array
    leaps: Leaps


@allocating
def make_modes(grid: BeamGrid, EI: float, yield_curvature: float) -> Modes:
    """Return the modes of a half beam, as many as it has spacings, at rest."""
    n = grid.mid - 1
    cosine = np.zeros(4 * n)
    for i in range(n):
        cosine[i] = math.cos(0.5 * math.pi * i / n)
        cosine[2 * n - i] = -cosine[i]
    for i in range(2 * n + 1, 4 * n):
        cosine[i] = cosine[4 * n - i]
    modes = Modes(
        np.empty(n + 1),
        np.empty(n + 1),
        np.empty(n + 1),
        np.empty(n + 1),
        np.empty(n + 1),
        np.empty(n + 1),
        np.zeros((grid.mid + 3, n + 1)),
        np.empty(n + 1),
        np.empty(n + 1, dtype=np.int64),
        np.empty(2),
        cosine,
        make_leaps(n + 1),
    )
    rest_modes(modes, grid, EI, yield_curvature)
    return modes


@compiled
def rest_modes(modes: Modes, grid: BeamGrid, EI: float, yield_curvature: float) -> None:
    """Make the modes those of another half beam of as many spacings, at rest."""
    n, speed = modes.q.size - 1, grid.dt * math.sqrt(EI / grid.mu)
    length = n * grid.dx
    left = length**3 / (6.0 * EI)  # of the static deflection per force, less the modes so far
    for p in range(n + 1):
        k2 = ((2 * p + 1) * (0.5 * math.pi / length)) ** 2
        D = 4.0 * math.sin(0.5 * min(speed * k2, 0.5 * math.pi)) ** 2
        flexibility = 1.0 / (EI * length * k2 * k2)
        flexibility = flexibility if p < n else max(flexibility, left)
        modes.k2[p], modes.D[p], modes.push[p] = k2, D, D * flexibility
        modes.q[p] = modes.u[p] = modes.source[p] = modes.seen[p] = 0.0
        left -= flexibility
    modes.k2[n] = 0.0  # it bends no section
    for i in range(n):
        angle = i  # in quarter turns over n, less whole turns
        for p in range(n):
            modes.bent[grid.mid - i, p] = -modes.k2[p] * modes.cosine[angle]
            angle += 2 * i if angle + 2 * i < 4 * n else 2 * i - 4 * n
    modes.near[0] = 0
    modes.slack[0], modes.slack[1] = yield_curvature, 0.0
    rest_leaps(modes.leaps)


@fused
def mode_curvature(q: Array, bent: Array, i: int) -> float:
    """Return the curvature of section i (1/m)."""
    kappa = 0.0
    for p in range(q.size):
        kappa += bent[i, p] * q[p]
    return kappa


@vectorised
def add_moment(source: Array, bent: Array, i: int, moment: float) -> None:
    """Add the moment of section i, times its length (N m2), to the source."""
    for p in range(source.size):
        source[p] += bent[i, p] * moment


@fused
def move_modes(
    q: Array,
    u: Array,
    D: Array,
    push: Array,
    source: Array,
    k2: Array,
    seen: Array,
    slack: Array,
    F: float,
) -> float:
    """Move all modes by one step under the contact force F (N).

    Returns the deflection at mid-span (m).
    """
    w, change = 0.0, 0.0
    for p in range(q.size):
        u[p] += push[p] * (F + source[p]) - D[p] * q[p]
        q[p] += u[p]
        w += q[p]
        change += k2[p] * abs(q[p] - seen[p])
    slack[1] = change
    return w


@summing
def modal_energy(q: Array, u: Array, D: Array, push: Array, source: Array, F: float) -> float:
    """Return the energy in J of a step's beginning, above what plastic strains store unbent.

    After the step, made under the contact force F (N).
    """
    energy = 0.0
    for p in range(q.size):
        q_now, stiffness = q[p] - u[p], D[p] / push[p]
        u_before = u[p] + D[p] * q_now - push[p] * (F + source[p])
        energy += 0.5 * u_before * u[p] / push[p] + (0.5 * stiffness * q_now - source[p]) * q_now
    return energy


@compiled
def deflect(modes: Modes, w: Array, now: int, mid: int) -> None:
    """Set the nodes' deflections w[now] (m) at the beginning of the last step."""
    for i in range(2, mid + 1):
        w[now, i] = 0.0
        for p in range(modes.q.size - 1):
            w[now, i] -= modes.bent[i, p] / modes.k2[p] * (modes.q[p] - modes.u[p])
