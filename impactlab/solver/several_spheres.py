"""Several spheres on the Euler-Bernoulli beam, by leapfrog.

The time loop (leapfrog.py) moves the first sphere; for it, the others are a part of the beam. Each
touches the beam at its node after its delay, whatever the beam does by then:

    m_s w_s'' = -F + m_s g,  w_s = w, w_s' = v at the delay;  F of w_s - w by the contact law.

A delay falls between two steps: w there is that of a straight line, and the sphere moves as without
a force until the later of them, an error of second order in the step. Spheres are alike and
undented, and their contacts do not know of each other.

The balance of energy has what each sphere has lost since its touch, and what its contact holds. The
kinetic energy of the beam is that of the velocities before and after a step, of which
euler_bernoulli.py finds those before without the other spheres' pushes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from impactlab.solver import euler_bernoulli, event_tracker
from impactlab.solver.beam import copies, mirror
from impactlab.solver.contact.history import CONTACT, Pair, energies
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.leapfrog import contact_force, fill_samples
from impactlab.solver.outputs import DIVERGED, ENERGY_OUT_OF_BALANCE, STRUCK_NEAR_END, blank
from impactlab.solver.responses import read_contact, read_inputs, read_rebound
from impactlab.solver.state import BeamModel, FurtherSpheres, State
from impactlab.solver.types import Array, Record, record

MOTION = record("velocity delay v v_before w w_0 u_before change", integers="node step begun")
"""Of a sphere: velocity (m/s) at first touch, delay (s); v, v_before (m/s): after and before the
step; w (m): displacement after it, counted as the beam's deflection, w_0: at first touch. u_before
(m): u of its node before the step, change: what its push adds. node; step: number of steps made;
begun: whether it has touched the beam."""

_PLAIN_STEP, _PLAIN_CURVATURE = euler_bernoulli.MODEL.step, euler_bernoulli.MODEL.curvature
_PLAIN_ENERGY = euler_bernoulli.MODEL.energy
_WHOLE_RUN = DIVERGED | ENERGY_OUT_OF_BALANCE


class Table(NamedTuple):
    """K further spheres in each of R runs.

    fastest: the cases, each with the sphere that asks for the smallest step, (R,). motions,
    contacts, events: records to work in; answers: RESPONSE records, filled, all (R, K). samples:
    those of kernels.py, filled, (R, K, 5, S), of which the force is of use.
    """

    fastest: Array
    motions: Array
    contacts: Array
    events: Array
    answers: Array
    samples: Array


class Further(NamedTuple):
    """The state of a run besides the beam's: front, that of euler_bernoulli.py, and spheres (K,).

    steps: number of steps of the run; mass (kg) and gravity (m/s2) of each sphere.
    """

    front: Array
    motions: Array
    contacts: Array
    events: Array
    samples: Array
    steps: int
    mass: float
    gravity: float


def make_table(cases: Array, samples: int) -> Table:
    """Return room for the further spheres of these cases, of which all have as many."""
    count = int(cases["further"][0])
    rows = cases["further_spheres"][:, :count]
    fastest, motions = cases.copy(), np.zeros(rows.shape[:2], MOTION)
    motions["velocity"], motions["delay"] = rows[..., 1], rows[..., 2]
    fastest["velocity"] = np.maximum(cases["velocity"], rows[..., 1].max(axis=1))
    ends = np.isin(rows[..., 0], (0.0, 1.0)).any(axis=1)
    fastest["strike_position"][ends] = 0.0  # half the mass to push
    return Table(
        fastest,
        motions,
        np.zeros(motions.shape, CONTACT),
        np.zeros(motions.shape, EVENTS),
        blank(motions.size).reshape(motions.shape),
        np.zeros((*motions.shape, 5, samples)),
    )


@allocating  # what it returns counts its owners
def _join(state: State, table: Table, r: int, case: Record) -> Further:
    """Return the front and the spheres of run r, before any touches the beam."""
    grid = state.grid
    for k in range(table.motions.shape[1]):
        sphere, contact, events = table.motions[r, k], table.contacts[r, k], table.events[r, k]
        place = case.further_spheres[k, 0]
        sphere.node = grid.first - 1 + int(place * (case.nodes - 1) + 0.5)
        event_tracker.start(events, contact, 0)
        events.contacts = events.touching = 0.0
    return Further(
        state.extra,
        table.motions[r],
        table.contacts[r],
        table.events[r],
        table.samples[r],
        round(case.duration / grid.dt),
        case.sphere_mass,
        case.gravity,
    )


@inlined
def _plain(state: State) -> State:
    """Return the state of the beam as euler_bernoulli.py has it."""
    pair, section, grid, beam, plastic, extra = state
    return State(pair, section, grid, beam, plastic, extra.front)


@compiled
def _touch(sphere: Record, events: Record, w: float, t: float, dt: float, gravity: float) -> None:
    """Let a sphere touch the beam t (s) before this step, at which the node is at w (m)."""
    sphere.begun, share = 1, t / dt
    sphere.w_0 = w - share * sphere.u_before
    sphere.w = sphere.w_0 + sphere.velocity * t + 0.5 * gravity * t * t
    sphere.v = sphere.velocity + gravity * (t - 0.5 * dt)
    events.w = events.w_before = events.w_max = w
    if sphere.w > w or t == 0.0:  # else the beam moves away
        events.contacts = events.touching = 1.0


@compiled
def _push(state: State, pair: Pair, k: int, now: int) -> None:
    """Move a sphere by one step, and push its node, which has been moved without it."""
    grid, extra, w, u = state.grid, state.extra, state.beam.w, state.beam.u
    sphere, contact, events = extra.motions[k], extra.contacts[k], extra.events[k]
    i, dt, step = sphere.node, grid.dt, sphere.step
    t = step * dt - sphere.delay
    sphere.step = step + 1
    if t < 0.0:
        return
    if sphere.begun == 0:
        _touch(sphere, events, w[now, i], t, dt, extra.gravity)
    before, delta = events.F, sphere.w - w[now, i]
    F = contact_force(contact, events, pair, delta, t, dt)
    sphere.v_before = sphere.v
    event_tracker.update_events(
        events, delta, contact.delta_r, w[now, i], F, sphere.v_before, t, dt
    )
    sphere.v += dt * (extra.gravity - F / extra.mass)
    sphere.w += dt * sphere.v
    sphere.change = grid.push * F / min(copies(grid, i), 1.0)  # more at a free end
    u[i] += sphere.change
    w[1 - now, i] += sphere.change
    front = extra.front
    front[0], front[2] = min(front[0], max(i - 2, 2)), max(front[2], min(i + 2, grid.last))
    samples = extra.samples[k]
    if samples.shape[1] > 0:
        start, end = (before, 0.0, 0.0, 0.0, 0.0), (F, 0.0, 0.0, 0.0, 0.0)
        fill_samples(samples, step, extra.steps, start, end)


@inlined
def _step(state: State, now: int, F: float) -> None:
    motions, u = state.extra.motions, state.beam.u
    for k in range(motions.size):
        motions[k].u_before = u[motions[k].node]
    _PLAIN_STEP(_plain(state), now, F)
    for k in range(motions.size):
        _push(state, state.pair, k, now)
    mirror(state.beam.w, now, u, state.grid)


@compiled
def _curvature(state: State, now: int) -> float:
    return _PLAIN_CURVATURE(_plain(state), now)


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    grid, u, extra = state.grid, state.beam.u, state.extra
    energy = _PLAIN_ENERGY(_plain(state), now, F, u_mid)
    for k in range(extra.motions.size):
        sphere, events = extra.motions[k], extra.events[k]
        if sphere.begun == 1:
            stored, lost = energies(extra.contacts[k], state.pair, events.delta)
            pushed = copies(grid, sphere.node) * u[sphere.node] * sphere.change
            fallen = sphere.w - grid.dt * sphere.v - sphere.w_0
            square = sphere.v_before * sphere.v - sphere.velocity * sphere.velocity
            energy += stored + lost - 0.5 * grid.mu * grid.dx / grid.dt**2 * pushed
            energy += extra.mass * (0.5 * square - extra.gravity * fallen)
            events.v_s, events.v_mid = sphere.v_before, sphere.u_before / grid.dt
    return energy


@compiled
def _brought(state: State) -> float:
    motions, squares = state.extra.motions, 0.0
    for k in range(motions.size):
        squares += motions[k].begun * motions[k].velocity ** 2
    return float(0.5 * state.extra.mass * squares)


@compiled
def _read(state: State, case: Record, answer: Record, answers: Array) -> None:
    """Fill in the answers of the further spheres; remark in the run's what they add."""
    extra, pair, grid = state.extra, state.pair, state.grid
    for k in range(extra.motions.size):
        other, events, contact = answers[k], extra.events[k], extra.contacts[k]
        if answer.status & _WHOLE_RUN:
            other.status = answer.status & _WHOLE_RUN
            continue
        read_contact(other, events, contact, pair)
        read_inputs(other, case, contact, pair)
        read_rebound(other, case, events)
        place = (extra.motions[k].node - grid.first + 1) * grid.dx
        near = min(place, case.beam_span - place) < case.beam_depth
        answer.remarks |= other.remarks | (STRUCK_NEAR_END if near else 0)


_PLAIN: Any = euler_bernoulli.MODEL
MODEL = BeamModel(
    _PLAIN.make,
    _step,
    _curvature,
    _energy,
    euler_bernoulli.deflected,
    _PLAIN.spread,
    settle=None,
    further=FurtherSpheres(_join, _read, _brought),
)
