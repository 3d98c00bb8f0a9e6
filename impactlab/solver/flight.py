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
whether a leap is clear. The largest deflection is looked for afterwards, in the leaps that may hide
it.
"""

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver.event_tracker import vertex
from impactlab.solver.jit import allocating, compiled, fused, inlined, vectorised
from impactlab.solver.types import Array

LEAST, MOST = 2, 11
"""Levels of leaps: of 4 steps at least, 2048 at most."""
_FAST = 1.0 / 16.0
"""D of modes that count as fast in a section: those that 16 steps turn by four radians."""
_ROOM = 8
"""The most leaps to hold."""

# What `memory` holds.
FRESH, LEVEL, WAIT, PATIENCE, BENT, _TABLES = range(6)
# What `swing` holds.
MOST_KAPPA, MOST_SLOPE = range(2)
# What `top` holds.
_SEEN, _FOUND = range(2)


class Leaps(NamedTuple):
    """Tables, bounds and memory of the leaps of n modes.

    D, S: D_m and S_m by level, (MOST + 1, n). rest: the modes' amplitudes at rest (m), (n,).
    trial: q and u after a leap that is tried; once it is made, those before, (2, n).

    A: the modes' swing (m), (n,). swing: the most that a curvature can differ from that at rest
    (1/m), and how fast this grows with the distance from the support (1/m2). bounds: of mid-span in
    a leap, by level, the second difference of slow modes and the swing of fast ones (m),
    (2, MOST + 1). watched: the number of sections
    that could yield, then which they are; kappa: their curvatures before and after a leap that is
    tried, second difference of slow modes, and swing of fast ones (1/m), (4, sections + 1).

    memory: whether `swing` holds; the level to try next; steps to wait before, and next time;
    whether `kappa` holds; the highest level of the tables.
    top: the largest deflection met between leaps, and found within (m). Of the leaps held, each of
    which may hide a larger one: levels (-1: none), the most that it can be (m), both (8,);
    held_bounds, its bounds, (8, 2, MOST + 1); held, its q, u and rest, (8, 3, n). path,
    spans: a stack of parts of a leap, q and u before each, (MOST + 2, 2, n); mid-span's deflection
    and last step there, the deflection after it (m), and its level, (MOST + 2, 4).
    """

    D: Array
    S: Array
    rest: Array
    trial: Array
    A: Array
    swing: Array
    bounds: Array
    watched: Array
    kappa: Array
    memory: Array
    top: Array
    levels: Array
    most: Array
    held_bounds: Array
    held: Array
    path: Array
    spans: Array


@allocating
def make_leaps(n: int, sections: int) -> Leaps:
    """Return room for the leaps of n modes and so many sections."""
    return Leaps(
        np.empty((MOST + 1, n)),
        np.empty((MOST + 1, n)),
        np.empty(n),
        np.empty((2, n)),
        np.empty(n),
        np.empty(2),
        np.empty((2, MOST + 1)),
        np.empty(sections + 1, dtype=np.int64),
        np.empty((4, sections + 1)),
        np.empty(6, dtype=np.int64),
        np.empty(2),
        np.empty(_ROOM, dtype=np.int64),
        np.empty(_ROOM),
        np.empty((_ROOM, 2, MOST + 1)),
        np.empty((_ROOM, 3, n)),
        np.empty((MOST + 2, 2, n)),
        np.empty((MOST + 2, 4)),
    )


@compiled
def rest_leaps(leaps: Leaps) -> None:
    """Forget all leaps, and their tables."""
    leaps.memory[_TABLES] = -1
    land(leaps, 0.0)


@compiled
def land(leaps: Leaps, w: float) -> None:
    """Forget all leaps; the beam is at rest, mid-span at w (m)."""
    memory = leaps.memory
    memory[FRESH] = memory[WAIT] = memory[PATIENCE] = memory[BENT] = 0
    memory[LEVEL] = LEAST
    leaps.top[_SEEN] = leaps.top[_FOUND] = w
    for k in range(_ROOM):
        leaps.levels[k] = -1


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
    bounds: Array,
) -> None:
    """Set `rest`, `A` (swings), `swing` and `bounds` of the free motion from here on."""
    most, slope = 0.0, 0.0
    for p in range(q.size):
        rest[p] = push[p] * source[p] / D[p]
        x = q[p] - rest[p]
        s = u[p] - 0.5 * D[p] * x
        A = math.sqrt(x * x + s * s / (D[p] * (1.0 - 0.25 * D[p])))
        most += k2[p] * A
        slope += k2[p] * math.sqrt(k2[p]) * A
        swings[p] = A
    swing[MOST_KAPPA], swing[MOST_SLOPE] = most, slope
    slow, bend, noise = q.size, 0.0, 0.0
    for p in range(q.size):
        bend += D[p] * swings[p]
    for level in range(MOST + 1):  # a mode is fast if its D is above 16/m^2
        while slow > 0 and D[slow - 1] * (1 << (2 * level)) > 16.0:
            slow -= 1
            bend -= D[slow] * swings[slow]
            noise += 2.0 * swings[slow]
        bounds[0, level], bounds[1, level] = bend, noise


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
    turn = 0.5 * steps - slope / bend
    return start - 0.5 * bend * turn * turn


@inlined
def note_leap(
    leaps: Leaps, q: Array, u: Array, D: Array, w: float, w_after: float, level: int, w_max: float
) -> None:
    """Hold a leap about to be made if it may hide the largest deflection.

    q, u: before it. w, w_after: deflection before and after (m). w_max: the largest so far (m).
    """
    top = leaps.top
    top[_SEEN] = max(top[_SEEN], w_max, w, w_after)
    most = _most(leaps.bounds, w, w_after, level)
    if most <= top[_SEEN]:
        return
    slot = _ROOM
    while slot > 0:
        slot -= 1
        if leaps.levels[slot] < 0 or leaps.most[slot] <= top[_SEEN]:
            break
    else:
        largest_deflection(leaps, D, w_max)
    leaps.levels[slot], leaps.most[slot] = level, most
    for p in range(q.size):
        leaps.held[slot, 0, p], leaps.held[slot, 1, p] = q[p], u[p]
        leaps.held[slot, 2, p] = leaps.rest[p]
    for k in range(level + 1):
        leaps.held_bounds[slot, 0, k] = leaps.bounds[0, k]
        leaps.held_bounds[slot, 1, k] = leaps.bounds[1, k]


@compiled
def _most(bounds: Array, w: float, w_after: float, level: int) -> float:
    """Return the most (m) that a vertex through three steps can be in a leap from w to w_after."""
    most = bounds[1, level] - lowest(-w, -w_after, 1 << level, bounds[0, level])
    return most + 0.125 * (bounds[0, 0] + bounds[1, 0])


@compiled
def largest_deflection(leaps: Leaps, D: Array, w_max: float) -> float:
    """Return the largest deflection (m), of the steps (w_max) and within the leaps so far."""
    top, levels, most = leaps.top, leaps.levels, leaps.most
    top[_SEEN] = max(top[_SEEN], w_max)
    for _ in range(_ROOM):  # the highest first, which rules out others
        k = 0
        for other in range(1, _ROOM):
            k = other if levels[other] >= 0 and (levels[k] < 0 or most[other] > most[k]) else k
        if levels[k] < 0 or most[k] <= top[_SEEN]:
            break
        _search(leaps, D, leaps.held[k], leaps.held_bounds[k], levels[k])
        levels[k] = -1
    for k in range(_ROOM):
        levels[k] = -1
    return max(w_max, top[_FOUND])


@compiled
def _search(leaps: Leaps, D: Array, held: Array, bounds: Array, level: int) -> None:
    """Find the largest vertex within a leap held.

    By halves, on a stack, and the half with the higher end first; those that can hold no larger one
    than is seen are dropped.
    """
    path, spans, rest, top, k = leaps.path, leaps.spans, held[2], leaps.top, 0
    w, U = _begin(held, path[0, 0], path[0, 1])
    state = path[0, 0], path[0, 1], D, rest, leaps.D, leaps.S
    w_end, _ = leap_modes(*state, level, path[1, 0], path[1, 1])
    spans[0, 0], spans[0, 1], spans[0, 2], spans[0, 3] = w, U, w_end, level
    while k >= 0:
        w, U, w_end, level = spans[k, 0], spans[k, 1], spans[k, 2], int(spans[k, 3])
        if level == 0 or _most(bounds, w, w_end, level) <= top[_SEEN]:
            if level == 0 and U > 0.0 and w_end <= w:
                _, value = vertex(w - U, w, w_end)
                top[_FOUND] = max(top[_FOUND], value)
                top[_SEEN] = max(top[_SEEN], value)
            k -= 1
            continue
        state = path[k, 0], path[k, 1], D, rest, leaps.D, leaps.S
        w_mid, U_mid = leap_modes(*state, level - 1, path[k + 1, 0], path[k + 1, 1])
        top[_SEEN] = max(top[_SEEN], w_mid)
        left, right = (k + 1, k) if w > w_end else (k, k + 1)
        if left > right:
            for p in range(rest.size):
                path[k, 0, p], path[k + 1, 0, p] = path[k + 1, 0, p], path[k, 0, p]
                path[k, 1, p], path[k + 1, 1, p] = path[k + 1, 1, p], path[k, 1, p]
        spans[left, 0], spans[left, 1], spans[left, 2] = w, U, w_mid
        spans[right, 0], spans[right, 1], spans[right, 2] = w_mid, U_mid, w_end
        spans[left, 3] = spans[right, 3] = level - 1
        k += 1


@compiled
def _begin(held: Array, q: Array, u: Array) -> tuple[float, float]:
    """Set q and u to those of a leap held; return mid-span's deflection and last step there (m)."""
    w, U = 0.0, 0.0
    for p in range(q.size):
        q[p], u[p] = held[0, p], held[1, p]
        w += q[p]
        U += u[p]
    return w, U
