"""The beam in its sine modes, each moved exactly: the scheme `modal`.

w(y, t) = sum of q_p(t) cos(k_p y), y the distance from mid-span, k_p = p pi/L for the odd p up to
N - 2: as many as the half beam has nodes, which are its sections. Curvature is exact, -k_p^2 of
each mode, and the sum over the nodes that takes the sections' moments to the modes is exact for
any product of two modes, so the elastic beam falls apart into oscillators of the exact frequencies
omega_p = k_p^2 sqrt((EI)_q/(rho A)) and the stiffness K_p = (EI)_q k_p^4 L/2:

    q(t + dt) - 2 q(t) + q(t - dt) = -D q + D/K (F + source),  D = 4 sin^2(omega dt/2)

with the contact force F and the source, the modes' share of the plastic moment
M_0 = M + (EI)_q kappa. D is exact for forces that are constant from t - dt to t + dt (Gautschi
1961); for others the step is of second order. Beyond omega dt = pi/2, D stays at 2: such modes
follow quasi-statically in the mean of two steps, which bounds the time step by the contact alone.

So do the modes left out: all with D = 2 obey one equation, so that their sum goes as one mode under
F alone. It has the flexibility that the others lack of L^3/(48 (EI)_q), and the D of the first.

It is leapfrog with the masses K dt^2/D, so it conserves as exactly the energy

    sum of u_before u_after K/(2 D) + K q^2/2 - source q, u = dt dq/dt at half steps

and is stable with perfectly plastic sections, too: with a share Pi of the sections yielding, the
step has the eigenvalues of D^(1/2) (1 - Pi) D^(1/2), which lie between 0 and 2.

Source: W. Gautschi, Numer. Math. 3 (1961) 381; Hochbruck, Lubich, Numer. Math. 83 (1999) 403.
"""

import math

from impactlab.solver.beam import BeamGrid, copies, is_end
from impactlab.solver.contact_patch import fading_share, wave_share
from impactlab.solver.fibre_plasticity import PlasticState, flow, plastic_energy
from impactlab.solver.flight import (
    BENT,
    FRESH,
    LEAST,
    LEVEL,
    MOST,
    MOST_KAPPA,
    MOST_SLOPE,
    PATIENCE,
    WAIT,
    bound_swing,
    exchange,
    land,
    largest_deflection,
    leap_modes,
    lowest,
    make_tables,
    note_leap,
    section_swing,
)
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.modes import (
    Modes,
    add_moment,
    curvature_change,
    deflect,
    make_modes,
    modal_energy,
    mode_curvature,
    move_modes,
    place,
    push_modes,
    rest_modes,
    settle_modes,
    span,
    take_modes,
)
from impactlab.solver.section import FibreSection, bend
from impactlab.solver.settle import ROUNDS, yields_at_rest
from impactlab.solver.state import BeamModel, Flight, State
from impactlab.solver.strain_rate import RateLaw
from impactlab.solver.types import Array, Record

_STEPS_UNSEEN = 8.0
"""Steps, at the present pace, for which sections far from yielding are left alone."""
_PATIENCE = 14
"""The most steps to wait after leaps have failed, before one is tried again."""


@inlined
def _look_at_all(modes: Modes, plastic: PlasticState, mid: int, last: int) -> None:
    """Find the sections that could yield in the next steps, and how long that holds."""
    near, pace = 0, 0.0
    for p in range(modes.q.size):
        modes.seen[p] = modes.q[p]
        pace += modes.k2[p] * abs(modes.u[p])
    modes.slack[0] = plastic.kappa_max[mid] - plastic.kappa_min[mid]
    for i in range(2, last + 1):
        kappa = mode_curvature(modes.q, modes.bent, i)
        left = min(plastic.kappa_max[i] - kappa, kappa - plastic.kappa_min[i])
        if left <= _STEPS_UNSEEN * pace:
            near += 1
            modes.near[near] = i
        else:
            modes.slack[0] = min(modes.slack[0], left)
    modes.near[0] = near


@compiled
def _bend(
    plastic: PlasticState,
    section: FibreSection,
    rate: RateLaw | None,
    i: int,
    kappa: float,
    dt: float,
) -> float:
    """Bend section i to kappa (1/m), by the rate if it has one; return its new M_0 (N m)."""
    if rate is not None and rate.D > 0.0:
        return flow(plastic, section, rate, i, kappa, dt)
    M_0, plastic.kappa_min[i], plastic.kappa_max[i] = bend(
        section, kappa, plastic.plastic_strain, plastic.peeq, i
    )
    return M_0


@inlined
def _take_moment(modes: Modes, plastic: PlasticState, grid: BeamGrid, i: int, M_0: float) -> None:
    """Make M_0 that of section i (N m), and bring its change to the modes."""
    length = copies(grid, i) * grid.dx
    add_moment(modes.source, modes.bent, i, length * (M_0 - plastic.M_0[i]))
    plastic.M_0[i] = M_0


@inlined
def bend_sections(
    modes: Modes, plastic: PlasticState, section: FibreSection, grid: BeamGrid
) -> None:
    """Bend the sections that yield, and bring their moments to the modes."""
    if modes.slack[1] >= modes.slack[0]:
        _look_at_all(modes, plastic, grid.mid, grid.last)
    for k in range(1, modes.near[0] + 1):
        i = modes.near[k]
        kappa = mode_curvature(modes.q, modes.bent, i)
        if kappa > plastic.kappa_max[i] or kappa < plastic.kappa_min[i]:
            M_0 = _bend(plastic, section, section.rate, i, kappa, grid.dt)
            _take_moment(modes, plastic, grid, i, M_0)
            modes.leaps.memory[FRESH] = 0


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Modes:
    return make_modes(grid, section.stiffness, section.yield_curvature, case.further)


@compiled
def _renew(modes: Modes, case: Record, section: FibreSection, grid: BeamGrid) -> None:
    rest_modes(modes, grid, section.stiffness, section.yield_curvature)


@inlined
def _step(state: State, now: int, F: float) -> None:
    q, u, k2, D, push, source, _, seen, near, slack, _, leaps, _ = state.extra
    w, mid = state.beam.w, state.grid.mid
    if near[0] > 0 or slack[1] >= slack[0]:
        bend_sections(state.extra, state.plastic, state.section, state.grid)
    w[1 - now, mid] = move_modes(q, u, D, push, source, k2, seen, slack, F)
    state.beam.u[mid] = w[1 - now, mid] - w[now, mid]
    if F > 0.0:
        leaps.memory[FRESH] = 0


@compiled
def _curvature(state: State, now: int) -> float:
    return mode_curvature(state.extra.q, state.extra.bent, state.grid.mid)


@inlined
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    stored, dissipated = plastic_energy(state.plastic, state.section, state.grid)
    q, u, _, D, push, source = state.extra[:6]
    return stored + dissipated + modal_energy(q, u, D, push, source, F)


@compiled
def _deflect(state: State, now: int) -> None:
    deflect(state.extra, state.beam.w, now, state.grid.last)


@compiled
def _share(modes: Modes, grid: BeamGrid, p: int, a: float) -> float:
    """Return the share of the force on mode p, when it is spread over the radius a (m)."""
    table = modes.table
    if table.size == 0:
        return float(wave_share(math.sqrt(modes.k2[p]) * a))
    if p == table.shape[1] - 1 or is_end(grid, grid.mid):  # nothing is spread beyond an end
        return 1.0
    z = math.sqrt(table[0, p]) / span(grid) * a
    return float(table[2, p] * wave_share(z) + (1.0 - table[2, p]) * fading_share(z))


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    q, u, k2, push = state.extra.q, state.extra.u, state.extra.k2, state.extra.push
    w, mean, moved, change = state.beam.w[1 - now], 0.0, 0.0, 0.0
    for p in range(q.size):
        share = _share(state.extra, state.grid, p, a)
        back = push[p] * F * (1.0 - share)
        u[p] -= back
        q[p] -= back
        moved += u[p]
        mean += share * u[p]
        change += k2[p] * abs(q[p] - state.extra.seen[p])
    state.extra.slack[1] = change
    w[state.grid.mid] += moved - state.beam.u[state.grid.mid]
    state.beam.u[state.grid.mid] = moved
    return mean - moved, 0.5 * F * (moved - mean)


@inlined
def begin_flight(
    modes: Modes, plastic: PlasticState, EI: float, grid: BeamGrid, unstressed: bool
) -> None:
    """Bound the free motion from here on, and list the sections that could yield in it.

    unstressed: whether the beam at rest without a force has no moment, as one that is simply
    supported: then its curvature is M_0/EI. That of others follows from the modes, and may be
    largest at an end.
    """
    leaps = modes.leaps
    swing, watched = leaps.swing, leaps.watched
    bound_swing(
        modes.q,
        modes.u,
        modes.k2,
        modes.D,
        modes.push,
        modes.source,
        leaps.rest,
        leaps.A,
        swing,
        leaps.bounds,
    )
    watched[0] = 0
    sines = modes.table.size == 0
    for i in range(2, grid.last + 1):
        kappa = plastic.M_0[i] / EI if unstressed else mode_curvature(leaps.rest, modes.bent, i)
        left = min(plastic.kappa_max[i] - kappa, kappa - plastic.kappa_min[i])
        most = (i - 1) * grid.dx * swing[MOST_SLOPE] if sines else swing[MOST_KAPPA]
        if min(swing[MOST_KAPPA], most) < left:
            continue
        most, bend, noise = section_swing(leaps.A, modes.D, modes.bent, i)
        if not most < left:
            watched[0] += 1
            k = watched[0]
            watched[k], leaps.kappa[2, k], leaps.kappa[3, k] = i, bend, noise
    leaps.memory[FRESH], leaps.memory[BENT] = 1, 0


@inlined
def _stays_elastic(modes: Modes, plastic: PlasticState, level: int) -> bool:
    """Return whether no section can yield in a leap that is tried."""
    leaps, steps = modes.leaps, 1 << level
    watched, kappa = leaps.watched, leaps.kappa
    if leaps.memory[BENT] == 0:
        for k in range(1, watched[0] + 1):
            kappa[0, k] = mode_curvature(modes.q, modes.bent, watched[k])
        leaps.memory[BENT] = 1
    for k in range(1, watched[0] + 1):
        i, bend, noise = watched[k], kappa[2, k], kappa[3, k]
        sag = 0.125 * bend * steps * steps + noise
        kappa[1, k] = mode_curvature(leaps.trial[0], modes.bent, i)
        low, high = min(kappa[0, k], kappa[1, k]), max(kappa[0, k], kappa[1, k])
        if low - sag < plastic.kappa_min[i] or high + sag > plastic.kappa_max[i]:
            low = lowest(kappa[0, k], kappa[1, k], steps, bend) - noise
            high = noise - lowest(-kappa[0, k], -kappa[1, k], steps, bend)
            if low < plastic.kappa_min[i] or high > plastic.kappa_max[i]:
                return False
    return True


@inlined
def _leap(
    state: State, now: int, gap: float, sphere: tuple[float, float], w_max: float, room: int
) -> int:
    """Leap as far as nothing can happen; return the number of steps, 0 for none.

    gap (m): between sphere and beam. sphere: its last step, and how much each grows by (m).
    w_max (m): the largest deflection so far. room: the most steps.
    """
    modes, beam, mid = state.extra, state.beam, state.grid.mid
    leaps, memory = modes.leaps, modes.leaps.memory
    if memory[WAIT] > 0:
        memory[WAIT] -= 1
        return 0
    if memory[FRESH] == 0:
        sines = modes.table.size == 0
        begin_flight(modes, state.plastic, state.section.stiffness, state.grid, sines)
    w = beam.w[now, mid]
    first = memory[LEVEL]
    for level in range(first, LEAST - 1, -1):
        steps = 1 << level
        if steps > room:
            continue
        make_tables(leaps, modes.D, level)
        w_after, U_after = leap_modes(
            modes.q,
            modes.u,
            modes.D,
            leaps.rest,
            leaps.D,
            leaps.S,
            level,
            leaps.trial[0],
            leaps.trial[1],
        )
        gap_after = gap + w_after - w - steps * (sphere[0] + 0.5 * (steps + 1) * sphere[1])
        least = lowest(gap, gap_after, steps, leaps.bounds[0, level] + sphere[1])
        if least > leaps.bounds[1, level] and _stays_elastic(modes, state.plastic, level):
            note_leap(leaps, modes.q, modes.u, modes.D, w, w_after, level, w_max)
            modes.slack[1] = exchange(modes.q, modes.u, leaps.trial, modes.k2, modes.seen)
            for k in range(1, leaps.watched[0] + 1):
                leaps.kappa[0, k] = leaps.kappa[1, k]
            beam.w[now, mid], beam.u[mid] = w_after, U_after
            memory[LEVEL] = min(level + 1, MOST) if level == first else level
            memory[PATIENCE] = 0
            return steps
    memory[LEVEL], memory[BENT] = LEAST, 0
    memory[PATIENCE] = min(2 * memory[PATIENCE] + 2, _PATIENCE)
    memory[WAIT] = memory[PATIENCE]
    return 0


@compiled
def _retrace(state: State) -> tuple[float, float]:
    """Make a step of the last leap once more; return deflection and curvature of mid-span."""
    leaps = state.extra.leaps
    q, u = leaps.trial[0], leaps.trial[1]
    w, _ = leap_modes(q, u, state.extra.D, leaps.rest, leaps.D, leaps.S, 0, q, u)
    return w, mode_curvature(q, state.extra.bent, state.grid.mid)


@compiled
def _settle(state: State) -> None:
    section, grid, beam, plastic, modes = state[1:]
    w, outside, rounds = 0.0, True, 0
    while outside and rounds < ROUNDS:
        w, outside, rounds = settle_modes(modes), False, rounds + 1
        for i in range(2, grid.last + 1):
            kappa = mode_curvature(modes.q, modes.bent, i)
            plastic.flowed[i, 0] = kappa
            if yields_at_rest(plastic, section, i, kappa):
                M_0, plastic.kappa_min[i], plastic.kappa_max[i] = bend(
                    section, kappa, plastic.plastic_strain, plastic.peeq, i
                )
                _take_moment(modes, plastic, grid, i, M_0)
                outside = True
    beam.w[0, grid.mid] = beam.w[1, grid.mid] = w
    beam.u[grid.mid] = 0.0
    land(modes.leaps, w)


@inlined
def _largest(state: State, w_max: float) -> float:
    return largest_deflection(state.extra.leaps, state.extra.D, w_max)


@compiled
def _land(state: State, w: float) -> None:
    land(state.extra.leaps, w)


@compiled
def _push(state: State, now: int, nodes: Array, forces: Array) -> float:
    """Add forces (state.py); with forces of 0, too, set deflection and step of the nodes."""
    modes, w, u, mid = state.extra, state.beam.w, state.beam.u, state.grid.mid
    moved, work, pushed = 0.0, 0.0, False
    for k in range(nodes.size):
        if forces[k] != 0.0:
            moved += push_modes(modes, nodes[k], forces[k])
            pushed = True
    if pushed:
        modes.slack[1], modes.leaps.memory[FRESH] = curvature_change(modes), 0
        w[1 - now, mid] += moved
        u[mid] += moved
    for k in range(nodes.size):
        i = nodes[k]
        w[1 - now, i], u[i] = place(modes.q, modes.table, i), place(modes.u, modes.table, i)
        work += forces[k] * u[i]
    return 0.5 * work


FLIGHT = Flight(_leap, _retrace, _largest, _land)
MODEL = BeamModel(
    _make,
    _step,
    _curvature,
    _energy,
    _deflect,
    _spread,
    flight_stride=64,
    flight=FLIGHT,
    renew=_renew,
    take=take_modes,
    settle=_settle,
    push=_push,
)
