"""The modal scheme with damping, and on Winkler's foundation.

The foundation k adds k/(rho A) to each omega^2, and its share to the stiffness K; modes and their
curvatures are the same. Damping is alpha and beta of Rayleigh, and one ratio zeta of all modes.

A free mode decays as exp(-r) cos(theta_d) in a step, with theta = omega dt up to pi/2 (modal.py),

    r = (alpha dt + beta theta^2/dt)/2 + zeta theta,   theta_d^2 = theta^2 - r^2,

which this step has exactly, for any r (of an overdamped mode theta_d is imaginary):

    u_after = g u - D q + D/K (F + source),   g = exp(-2 r),   D = 1 + g - 2 exp(-r) cos(theta_d)

A rigid mode has no theta, so alpha alone damps it, with D/K = dt^2/m (1 - g)/(2 r).

It is leapfrog with the masses K dt^2 (1 + g)/(2 D) and a central damper, which takes the work
K (1 - g) (u_after + u)^2/(4 D) from each mode in a step; so the energy is

    sum of K (1 + g)/(4 D) u_before u + K q^2/2 - source q, u = dt dq/dt at half steps

and half of the last step's work. Contact and yielding are stable with the time step of undamped
modes: at -1 a mode counts by D/(2 + 2 g - D) = |tanh((r + i theta_d)/2)|^2 where it had
tan^2(theta/2), which is no less. Leaps (flight.py) are of undamped modes: a damped run has none.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from impactlab.solver import modal
from impactlab.solver.beam import BeamGrid
from impactlab.solver.fibre_plasticity import plastic_energy
from impactlab.solver.flight import FRESH, WAIT
from impactlab.solver.jit import allocating, compiled, fused, inlined, summing
from impactlab.solver.modes import Modes, count, make_modes, rest_modes, span, take_modes
from impactlab.solver.section import FibreSection
from impactlab.solver.state import BeamModel, Flight, State
from impactlab.solver.types import Array, Record

_PLAIN_STEP, _PLAIN_ENERGY = modal.MODEL.step, modal.MODEL.energy
_PLAIN_CURVATURE, _PLAIN_DEFLECT = modal.MODEL.curvature, modal.MODEL.deflect
_PLAIN_SPREAD = modal.MODEL.spread
_PLAIN_SETTLE: Any = modal.MODEL.settle
_PLAIN_PUSH: Any = modal.MODEL.push
_PLAIN_LEAP, _PLAIN_RETRACE, _PLAIN_LARGEST, _PLAIN_LAND = modal.FLIGHT
_LEFT_OUT = 3.0 / 7.0
"""Of the foundation, of the modes left out: their sum of k^-8 over that of k^-4 and the first."""


class ResistedModes(NamedTuple):
    """Modes, and what resists them.

    decay: g; before: u a step earlier (m); lost: the work of damping before the last step (J), of
    each mode; (n + 1,). acts: whether there is any damping, and a foundation, (2,).
    """

    modes: Modes
    decay: Array
    before: Array
    lost: Array
    acts: Array


@allocating
def make(case: Record, section: FibreSection, grid: BeamGrid) -> ResistedModes:
    """Return modes at rest, which renew makes those of a case."""
    modes = make_modes(grid, section.stiffness, section.yield_curvature, case.further)
    size = modes.q.size
    return ResistedModes(
        modes, np.ones(size), np.zeros(size), np.zeros(size), np.zeros(2, dtype=np.int64)
    )


@compiled
def take(extra: ResistedModes, table: Array) -> None:
    """Take over a table of modes."""
    take_modes(extra.modes, table)


@compiled
def renew(extra: ResistedModes, case: Record, section: FibreSection, grid: BeamGrid) -> None:
    """Make the modes those of another case, at rest."""
    rest_modes(extra.modes, grid, section.stiffness, section.yield_curvature)
    damping = case.mass_damping + case.stiffness_damping + case.damping_ratio
    extra.acts[0] = 1 if damping > 0.0 else 0
    extra.acts[1] = 1 if case.foundation_stiffness > 0.0 else 0
    if damping > 0.0 or case.foundation_stiffness > 0.0:
        _resist(extra, case, grid, section.stiffness)


@compiled
def _resist(extra: ResistedModes, case: Record, grid: BeamGrid, EI: float) -> None:
    """Let damping and foundation resist modes at rest."""
    modes, dt = extra.modes, grid.dt
    bed = dt * dt * case.foundation_stiffness / grid.mu
    for p in range(modes.q.size):
        bending, flexibility = _angle(modes, grid, EI, p) ** 2, modes.push[p] / modes.D[p]
        if bending > 0.0:
            share = 1.0 if p < count(modes) else _LEFT_OUT
            flexibility /= 1.0 + share * bed / bending
        elif bed > 0.0:
            flexibility = modes.push[p] / bed
        theta = min(math.sqrt(bending + bed), 0.5 * math.pi)
        r = 0.5 * (case.mass_damping * dt + case.stiffness_damping * theta * theta / dt)
        r += case.damping_ratio * theta
        extra.decay[p], extra.before[p], extra.lost[p] = math.exp(-2.0 * r), 0.0, 0.0
        if theta > 0.0:
            modes.D[p] = damped_turn(theta, r)
            modes.push[p] = modes.D[p] * flexibility
        elif r > 0.0:
            modes.push[p] *= -0.5 * math.expm1(-2.0 * r) / r


@compiled
def _angle(modes: Modes, grid: BeamGrid, EI: float, p: int) -> float:
    """Return omega dt of a mode without damping or foundation (rad)."""
    speed = grid.dt * math.sqrt(EI / grid.mu)
    if modes.table.size > 0:
        return float(speed * modes.table[0, p] / span(grid) ** 2)
    length = (modes.q.size - 1) * grid.dx
    return float(speed * ((2 * p + 1) * (0.5 * math.pi / length)) ** 2)


@compiled
def damped_turn(theta: float, r: float) -> float:
    """Return D of a mode that turns by theta in a step and decays by exp(-r)."""
    square = theta * theta - r * r
    if square >= 0.0:
        sine = math.sin(0.5 * math.sqrt(square))
        return math.expm1(-r) ** 2 + 4.0 * math.exp(-r) * sine * sine
    fast = r + math.sqrt(-square)
    return math.expm1(-theta * theta / fast) * math.expm1(-fast)


@inlined
def _plain(state: State) -> State:
    """Return the state of the beam as modal.py has it."""
    pair, section, grid, beam, plastic, extra = state
    return State(pair, section, grid, beam, plastic, extra.modes)


@fused
def move_damped(modes: Modes, decay: Array, before: Array, lost: Array, F: float) -> float:
    """Move all modes by one step under the contact force F (N).

    Returns the deflection at the struck node (m).
    """
    q, u, k2, D, push, source, _, seen, _, slack, _, _, _ = modes
    w, change = 0.0, 0.0
    for p in range(q.size):
        twice = u[p] + before[p]
        lost[p] += 0.25 * (1.0 - decay[p]) / push[p] * twice * twice
        before[p] = u[p]
        u[p] = decay[p] * u[p] + push[p] * (F + source[p]) - D[p] * q[p]
        q[p] += u[p]
        w += q[p]
        change += k2[p] * abs(q[p] - seen[p])
    slack[1] = change
    return w


@summing
def damped_energy(modes: Modes, decay: Array, before: Array, lost: Array) -> float:
    """Return the energy in J of a step's beginning, as modal_energy, and what damping took."""
    energy, (q, u, _, D, push, source) = 0.0, modes[:6]
    for p in range(q.size):
        q_now, stiffness = q[p] - u[p], D[p] / push[p]
        energy += lost[p] + (0.5 * stiffness * q_now - source[p]) * q_now
        taken = (1.0 - decay[p]) * (u[p] + before[p])
        energy += 0.25 * before[p] * ((1.0 + decay[p]) * u[p] + taken) / push[p]
    return energy


@inlined
def _step(state: State, now: int, F: float) -> None:
    extra = state.extra
    if extra.acts[0] == 0:
        _PLAIN_STEP(_plain(state), now, F)
    else:
        modes, w, mid = extra.modes, state.beam.w, state.grid.mid
        if modes.near[0] > 0 or modes.slack[1] >= modes.slack[0]:
            modal.bend_sections(modes, state.plastic, state.section, state.grid)
        w[1 - now, mid] = move_damped(modes, extra.decay, extra.before, extra.lost, F)
        state.beam.u[mid] = w[1 - now, mid] - w[now, mid]


@compiled
def _curvature(state: State, now: int) -> float:
    return _PLAIN_CURVATURE(_plain(state), now)


@inlined
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    extra = state.extra
    if extra.acts[0] == 0:
        return _PLAIN_ENERGY(_plain(state), now, F, u_mid)
    stored, dissipated = plastic_energy(state.plastic, state.section, state.grid)
    energy = damped_energy(extra.modes, extra.decay, extra.before, extra.lost)
    return stored + dissipated + energy


@compiled
def _deflect(state: State, now: int) -> None:
    _PLAIN_DEFLECT(_plain(state), now)


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    ahead, missing = _PLAIN_SPREAD(_plain(state), now, F, a)
    return ahead, 0.0 if state.extra.acts[0] else missing  # `before` knows of the force's place


@inlined
def _leap(
    state: State, now: int, gap: float, sphere: tuple[float, float], w_max: float, room: int
) -> int:
    extra, memory = state.extra, state.extra.modes.leaps.memory
    if extra.acts[0]:
        return 0
    if extra.acts[1] and memory[WAIT] == 0 and memory[FRESH] == 0:
        modal.begin_flight(extra.modes, state.plastic, state.section.stiffness, state.grid, False)
    return _PLAIN_LEAP(_plain(state), now, gap, sphere, w_max, room)


@compiled
def _retrace(state: State) -> tuple[float, float]:
    return _PLAIN_RETRACE(_plain(state))


@inlined
def _largest(state: State, w_max: float) -> float:
    return _PLAIN_LARGEST(_plain(state), w_max)


@compiled
def _land(state: State, w: float) -> None:
    _PLAIN_LAND(_plain(state), w)


@compiled
def _settle(state: State) -> None:
    extra = state.extra
    for p in range(extra.before.size):
        extra.before[p] = extra.lost[p] = 0.0
    _PLAIN_SETTLE(_plain(state))


@compiled
def _push(state: State, now: int, nodes: Array, forces: Array) -> float:
    surplus = _PLAIN_PUSH(_plain(state), now, nodes, forces)
    return 0.0 if state.extra.acts[0] else surplus  # `before` knows of all forces


MODEL = BeamModel(
    make,
    _step,
    _curvature,
    _energy,
    _deflect,
    _spread,
    _settle,
    flight_stride=modal.MODEL.flight_stride,
    flight=Flight(_leap, _retrace, _largest, _land),
    renew=renew,
    take=take,
    push=_push,
)
