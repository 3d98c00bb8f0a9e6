"""Leaps over many steps at once, of modes that no force drives and that bend no section too far.

The step of a free mode turns it by the angle theta about its rest, D = 4 sin^2(theta/2). With
x = q - rest and s = (x(t + dt) - x(t - dt))/2, m steps are

    x_m = x - D_m/2 x + S_m s,   s_m = s - D_m/2 s - D (1 - D/4) S_m x,
    D_m = 4 sin^2(m theta/2),    S_m = sin(m theta)/sin(theta),

the same numbers as those of m single steps, to round-off. Those of m = 2^level follow from each
other: D_2m = D_m (4 - D_m), S_2m = S_m (2 - D_m).

A leap must hide no event. A mode swings to A at most, and its second difference to D A. So a sum of
modes leaves the straight line between two values m steps apart by at most

    sag = sum over slow modes of D A m^2/8 + sum over fast ones of 2 A.

From the gap's two ends, and those of the curvature of each section that could yield at all, follows
whether a leap is clear. The largest deflection is looked for afterwards, in the one leap that may
hide it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver.event_tracker import vertex
from impactlab.solver.jit import allocating, compiled, fused, inlined, vectorised
from impactlab.solver.types import Array

LEAST, MOST = 2, 11
"""Levels of leaps: of 4 steps at least, 2048 at most."""
_FAST = 1.0 / 16.0
"""D of modes that count as fast: those that 16 steps turn by four radians."""

# What `memory` holds.
FRESH, LEVEL, WAIT, PATIENCE, BENT, _TABLES, _HELD = range(7)
# What `swing` holds.
BEND_W, NOISE_W, MOST_KAPPA, MOST_SLOPE = range(4)
# What `top` holds.
_SEEN, _FOUND, _BOUND, _BEND, _NOISE = range(5)


class Leaps(NamedTuple):
    """Tables, bounds and memory of the leaps of n modes.

    D, S: D_m and S_m by level, (MOST + 1, n). rest: the modes' amplitudes at rest (m), (n,).
    trial: q and u after a leap that is tried; once it is made, those before, (2, n).

    A: the modes' swing (m), (n,). swing: of mid-span, the second difference of slow modes and the
    swing of fast ones (m); then the most that a curvature can differ from that at rest (1/m), and
    how fast this grows with the distance from the support (1/m2). watched: the number of sections
    that could yield, then which they are; kappa: their curvatures before and after a leap that is
    tried, second difference of slow modes, and swing of fast ones (1/m), (4, n + 1).

    memory: whether `swing` holds; the level to try next; steps to wait before, and next time;
    whether `kappa` holds; the highest level of the tables; the level of the leap held, or -1.
    top: the largest deflection met between leaps, and found within (m); of the leap held, in which
    a larger one may be, the bound, and the two of `swing`. held: its q, u and rest, then work
    space, (7, n).
    """

    D: Array
    S: Array
    rest: Array
    trial: Array
    A: Array
    swing: Array
    watched: Array
    kappa: Array
    memory: Array
    top: Array
    held: Array


@allocating
def make_leaps(n: int) -> Leaps:
    """Return the leaps of n modes, before any."""
    memory = np.zeros(7, dtype=np.int64)
    memory[LEVEL], memory[_TABLES], memory[_HELD] = LEAST, -1, -1
    return Leaps(
        np.empty((MOST + 1, n)),
        np.empty((MOST + 1, n)),
        np.empty(n),
        np.empty((2, n)),
        np.empty(n),
        np.empty(4),
        np.empty(n + 1, dtype=np.int64),
        np.empty((4, n + 1)),
        memory,
        np.zeros(5),
        np.empty((7, n)),
    )


@vectorised
def _double(D: Array, S: Array, level: int) -> None:
    for p in range(D.shape[1]):
        D[level, p] = D[level - 1, p] * (4.0 - D[level - 1, p])
        S[level, p] = S[level - 1, p] * (2.0 - D[level - 1, p])


@inlined
def make_tables(leaps: Leaps, D: Array, level: int) -> None:
    """Make the tables up to a level, where they are not made yet."""
    while leaps.memory[_TABLES] < level:
        leaps.memory[_TABLES] += 1
        if leaps.memory[_TABLES] > 0:
            _double(leaps.D, leaps.S, leaps.memory[_TABLES])
        else:
            for p in range(D.size):
                leaps.D[0, p], leaps.S[0, p] = D[p], 1.0


@vectorised
def bound_swing(
    q: Array,
    u: Array,
    k2: Array,
    D: Array,
    push: Array,
    source: Array,
    rest: Array,
    swings: Array,
    swing: Array,
) -> None:
    """Set `rest`, `A` (swings) and `swing` of the free motion from here on."""
    bend, noise, most, slope = 0.0, 0.0, 0.0, 0.0
    for p in range(q.size):
        rest[p] = push[p] * source[p] / D[p]
        x = q[p] - rest[p]
        s = u[p] - 0.5 * D[p] * x
        A = math.sqrt(x * x + s * s / (D[p] * (1.0 - 0.25 * D[p])))
        bend += 0.0 if D[p] > _FAST else D[p] * A
        noise += 2.0 * A if D[p] > _FAST else 0.0
        most += k2[p] * A
        slope += k2[p] * math.sqrt(k2[p]) * A
        swings[p] = A
    swing[BEND_W], swing[NOISE_W], swing[MOST_KAPPA], swing[MOST_SLOPE] = bend, noise, most, slope


@vectorised
def section_swing(A: Array, D: Array, bent: Array, i: int) -> tuple[float, float, float]:
    """Return how far the curvature of section i can swing (1/m), then see `kappa` of Leaps."""
    most, bend, noise = 0.0, 0.0, 0.0
    for p in range(A.size):
        swing = abs(bent[i, p]) * A[p]
        most += swing
        bend += 0.0 if D[p] > _FAST else D[p] * swing
        noise += 2.0 * swing if D[p] > _FAST else 0.0
    return most, bend, noise


@fused
def leap_modes(
    q: Array,
    u: Array,
    D: Array,
    rest: Array,
    leap_D: Array,
    leap_S: Array,
    level: int,
    q_after: Array,
    u_after: Array,
) -> tuple[float, float]:
    """Set q and u after 2^level free steps; return mid-span's deflection and last step there (m).

    q_after, u_after: may be q and u.
    """
    w, step = 0.0, 0.0
    for p in range(q.size):
        x = q[p] - rest[p]
        s = u[p] - 0.5 * D[p] * x
        less, sine = 0.5 * leap_D[level, p], leap_S[level, p]
        x_after = x - less * x + sine * s
        s_after = s - less * s - D[p] * (1.0 - 0.25 * D[p]) * sine * x
        q_after[p], u_after[p] = x_after + rest[p], s_after + 0.5 * D[p] * x_after
        w += q_after[p]
        step += u_after[p]
    return w, step


@fused
def exchange(q: Array, u: Array, trial: Array, k2: Array, seen: Array) -> float:
    """Take over the state after a leap; return what curvatures can differ by since `seen` (1/m)."""
    change = 0.0
    for p in range(q.size):
        q[p], trial[0, p] = trial[0, p], q[p]
        u[p], trial[1, p] = trial[1, p], u[p]
        change += k2[p] * abs(q[p] - seen[p])
    return change


@inlined
def lowest(start: float, end: float, steps: int, bend: float) -> float:
    """Return the least that a sum of slow modes can be between two values so many steps apart.

    bend: the most that its second difference can be.
    """
    slope = (end - start) / steps
    if abs(slope) >= 0.5 * bend * steps:
        return min(start, end)
    at = 0.5 * steps - slope / bend
    return start - 0.5 * bend * at * at


@inlined
def note_leap(
    leaps: Leaps, q: Array, u: Array, D: Array, w: float, w_after: float, level: int, w_max: float
) -> None:
    """Hold a leap about to be made if it may hide the largest deflection.

    q, u: before it. w, w_after: deflection before and after (m). w_max: the largest so far (m).
    """
    memory, top, bend, noise = leaps.memory, leaps.top, leaps.swing[BEND_W], leaps.swing[NOISE_W]
    top[_SEEN] = max(top[_SEEN], w_max, w, w_after)
    bound = noise - lowest(-w, -w_after, 1 << level, bend) + 0.125 * (bend + noise)
    if bound <= top[_SEEN]:
        return
    largest_deflection(leaps, D, w_max)
    if bound <= top[_SEEN]:
        return
    memory[_HELD], top[_BOUND], top[_BEND], top[_NOISE] = level, bound, bend, noise
    for p in range(q.size):
        leaps.held[0, p], leaps.held[1, p], leaps.held[2, p] = q[p], u[p], leaps.rest[p]


@compiled
def largest_deflection(leaps: Leaps, D: Array, w_max: float) -> float:
    """Return the largest deflection (m), of the steps (w_max) and within the leaps so far.

    A leap held is walked through if it may hide a larger one: first by halves to near a peak, if
    the velocity changes sign; then from its start, in leaps that hide none and single steps.
    """
    memory, top, held = leaps.memory, leaps.top, leaps.held
    level, memory[_HELD] = memory[_HELD], -1
    known = max(top[_SEEN], w_max)
    if level >= 0 and top[_BOUND] > known:
        q, u, rest, q_after, u_after = held[0], held[1], held[2], held[5], held[6]
        w, U = 0.0, 0.0
        for p in range(q.size):
            held[3, p], held[4, p] = q[p], u[p]
            w += q[p]
            U += u[p]
        _, U_after = leap_modes(q, u, D, rest, leaps.D, leaps.S, level, q_after, u_after)
        for half in range(level - 1, -1 if U > 0.0 > U_after else level - 1, -1):
            w_after, U_after = leap_modes(
                held[3], held[4], D, rest, leaps.D, leaps.S, half, q_after, u_after
            )
            known = max(known, w_after)
            for p in range(q.size if U_after > 0.0 else 0):
                held[3, p], held[4, p] = q_after[p], u_after[p]
        left, level, held_back = 1 << level, level - 1, 1
        while left > 0:
            while 1 << level > left:
                level -= 1
            w_after, U_after = leap_modes(q, u, D, rest, leaps.D, leaps.S, level, q_after, u_after)
            bound = top[_NOISE] - lowest(-w, -w_after, 1 << level, top[_BEND])
            if level > 0 and bound + 0.125 * (top[_BEND] + top[_NOISE]) > known:
                level, held_back = level - 1, 1
                continue
            if level == 0 and U > 0.0 and w_after <= w:
                _, value = vertex(w - U, w, w_after)
                top[_FOUND] = max(top[_FOUND], value)
            left -= 1 << level
            level, held_back = level + 1 - held_back, 0
            w, U, known = w_after, U_after, max(known, w_after, top[_FOUND])
            for p in range(q.size):
                q[p], u[p] = q_after[p], u_after[p]
        top[_SEEN] = known
    return max(w_max, top[_FOUND])
