"""The modes of a beam: what a run keeps of them, and the loops over them.

The scheme's equations are in modal.py; see there for D, and for the last entry, which stands for
all modes left out. They are sines in a pinned half beam; of others, a table comes from outside
(model/beam_modes.py), which `take_modes` hands on.
"""

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import CLAMPED, PINNED, SYMMETRIC, BeamGrid
from impactlab.solver.flight import Leaps, make_leaps, rest_leaps
from impactlab.solver.jit import allocating, compiled, fused, summing, vectorised
from impactlab.solver.types import Array


class Modes(NamedTuple):
    """The modes of a run, n of them, and the sum of those left out in entry n.

    Further entries, m - n - 1 of them, are what those left out add at each further sphere.

    q: amplitude (m), by the deflection at the struck node. u: dt dq/dt half a step before (m). k2:
    the largest curvature per amplitude, k_p^2 of sines (1/m2). D: see modal.py. push:
    D/K (m/N). source (N): sum over the nodes of M_0 times the mode's curvature. Each (m,).
    bent: curvature of node i per amplitude, (last + 3, m), 1/m2; nodes as in beam.py. seen: q
    when all sections were last looked at, (m,). near: the number of sections that could yield
    before the next such look, then which they are, (last,). slack: what the curvature of any other
    may have changed by until that look, and can have changed by now (1/m), (2,). cosine: of quarter
    turns over n, (4 n,). leaps: see flight.py. table: that of model/beam_modes.py, (3 + 2 last - 2,
    m); of sines without any entry.
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
    table: Array


_RIGID = 1e-30
"""D of a mode that does not bend the beam: as good as none, and no division by zero."""


@compiled
def has_sines(grid: BeamGrid) -> bool:
    """Return whether the modes are sines: of a pinned half beam."""
    return bool(grid.left == PINNED and grid.right == SYMMETRIC)


@allocating
def make_modes(grid: BeamGrid, EI: float, yield_curvature: float, further: int = 0) -> Modes:
    """Return the modes, at rest, as many as nodes move; those of others than sines are blank.

    further: number of further spheres.
    """
    n = grid.last - 1
    for kind in (grid.left, grid.right):
        n -= 1 if kind == CLAMPED else 0
    sines, size = has_sines(grid), n + 1 + further
    cosine = np.zeros(4 * n)
    for i in range(n):
        cosine[i] = math.cos(0.5 * math.pi * i / n)
        cosine[2 * n - i] = -cosine[i]
    for i in range(2 * n + 1, 4 * n):
        cosine[i] = cosine[4 * n - i]
    modes = Modes(
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.zeros((grid.last + 3, size)),
        np.empty(size),
        np.empty(grid.last, dtype=np.int64),
        np.empty(2),
        cosine,
        make_leaps(size, grid.last - 1),
        np.zeros((0 if sines else 1 + 2 * grid.last, 0 if sines else size)),
    )
    if sines:
        rest_modes(modes, grid, EI, yield_curvature)
    return modes


@compiled
def count(modes: Modes) -> int:
    """Return the number n of modes, without entries for those left out."""
    return modes.cosine.size // 4


@compiled
def take_modes(modes: Modes, table: Array) -> None:
    """Take over a table of modes; rest_modes makes them those of a beam."""
    for i in range(modes.table.shape[0]):
        for p in range(modes.table.shape[1]):
            modes.table[i, p] = table[i, p]


@compiled
def rest_modes(modes: Modes, grid: BeamGrid, EI: float, yield_curvature: float) -> None:
    """Make the modes those of another beam of as many spacings and the same ends, at rest."""
    if modes.table.size > 0:
        _scale_table(modes, grid, EI)
    else:
        _scale_sines(modes, grid, EI)
    modes.near[0] = 0
    modes.slack[0], modes.slack[1] = yield_curvature, 0.0
    rest_leaps(modes.leaps)


@compiled
def _scale_sines(modes: Modes, grid: BeamGrid, EI: float) -> None:
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


@compiled
def span(grid: BeamGrid) -> float:
    """Return the span of the whole beam (m)."""
    return grid.copies * (grid.stop - grid.first + 1) * grid.dx


@compiled
def _scale_table(modes: Modes, grid: BeamGrid, EI: float) -> None:
    n, length, table = count(modes), span(grid), modes.table
    speed, mass = grid.dt * math.sqrt(EI / grid.mu) / length**2, grid.mu * length
    for p in range(modes.q.size):
        b2 = table[0, p]
        D = 4.0 * math.sin(0.5 * min(speed * b2, 0.5 * math.pi)) ** 2
        modes.D[p] = D if b2 > 0.0 else _RIGID
        if p >= n:
            modes.push[p] = D * table[1, p] * length**3 / EI
        elif b2 > 0.0:
            modes.push[p] = D * table[1, p] * length**3 / (EI * b2 * b2)
        else:
            modes.push[p] = grid.dt**2 * table[1, p] / mass
        modes.q[p] = modes.u[p] = modes.source[p] = modes.seen[p] = modes.k2[p] = 0.0
        for i in range(2, grid.last + 1):
            modes.bent[i, p] = table[grid.last + i, p] / length**2
            modes.k2[p] = max(modes.k2[p], abs(modes.bent[i, p]))


@compiled
def settle_modes(modes: Modes) -> float:
    """Put all modes to rest under the source; return the deflection at mid-span (m)."""
    w = 0.0
    for p in range(modes.q.size):
        modes.q[p], modes.u[p] = modes.push[p] * modes.source[p] / modes.D[p], 0.0
        w += modes.q[p]
    modes.slack[1] = modes.slack[0]  # look at all sections in the next step
    return w


@fused
def mode_curvature(q: Array, bent: Array, i: int) -> float:
    """Return the curvature of section i (1/m)."""
    kappa = 0.0
    for p in range(q.size):
        kappa += bent[i, p] * q[p]
    return kappa


@fused
def place(amplitudes: Array, table: Array, i: int) -> float:
    """Return the deflection at node i of amplitudes of the modes (m), by their table."""
    w = 0.0
    for p in range(amplitudes.size):
        w += table[1 + i, p] * amplitudes[p]
    return w


@fused
def push_modes(modes: Modes, i: int, F: float) -> float:
    """Add the force F (N) on node i to a step; return what it adds at the struck node (m)."""
    q, u, push, table, moved = modes.q, modes.u, modes.push, modes.table, 0.0
    for p in range(q.size):
        change = push[p] * table[1 + i, p] * F
        u[p] += change
        q[p] += change
        moved += change
    return moved


@fused
def curvature_change(modes: Modes) -> float:
    """Return what any curvature can have changed by since all were last looked at (1/m)."""
    q, k2, seen, change = modes.q, modes.k2, modes.seen, 0.0
    for p in range(q.size):
        change += k2[p] * abs(q[p] - seen[p])
    return change


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
def deflect(modes: Modes, w: Array, now: int, last: int) -> None:
    """Set the nodes' deflections w[now] (m) at the beginning of the last step."""
    for i in range(2, last + 1):
        w[now, i] = 0.0
        for p in range(count(modes)):
            if modes.table.size > 0:
                w[now, i] += modes.table[1 + i, p] * (modes.q[p] - modes.u[p])
            else:
                w[now, i] -= modes.bent[i, p] / modes.k2[p] * (modes.q[p] - modes.u[p])
