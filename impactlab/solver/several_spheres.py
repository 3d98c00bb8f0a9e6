"""Several spheres on one beam, of any model and scheme that can be pushed beside its struck node.

The time loop (leapfrog.py) moves the first sphere; for it, the others are a part of the beam. Each
touches the beam at its node after its delay, whatever the beam does by then:

    m_s w_s'' = -F + m_s g,  w_s = w, w_s' = v at the delay;  F of w_s - w by the contact law.

Its contact is that of the time loop, in whose grid its node is the struck one: local compliance and
a strip's bending across are those there. A delay falls between two steps: w there is that of a
straight line, and the sphere moves as without a force until the later of them, an error of second
order in the step. Spheres are alike and undented, and their contacts know of each other through the
beam alone.

The balance of energy has what each sphere has lost since its touch, and what its contact holds.
Leaps (flight.py) are made until the first of these spheres comes.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from impactlab.solver import event_tracker
from impactlab.solver.beam import BeamGrid
from impactlab.solver.contact.history import CONTACT, energies
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.leapfrog import contact_of, fill_samples
from impactlab.solver.outputs import DIVERGED, ENERGY_OUT_OF_BALANCE, STRUCK_NEAR_END, blank
from impactlab.solver.responses import read_contact, read_inputs, read_rebound
from impactlab.solver.state import BeamModel, Flight, FurtherSpheres, State
from impactlab.solver.types import Array, Record, record

MOTION = record("velocity delay v v_before w w_0 u_before face", integers="step begun")
"""Of a sphere: velocity (m/s) at first touch, delay (s); v, v_before (m/s): after and before the
step; w (m): displacement after it, counted as the beam's deflection, w_0: at first touch. u_before
(m): u of its node before the step, face: where the struck face was a step ago, before the touch.
step: number of steps made; begun: whether it has touched the beam."""

_WHOLE_RUN = DIVERGED | ENERGY_OUT_OF_BALANCE


class Table(NamedTuple):
    """K further spheres in each of R runs.

    fastest: the cases, each with the spheres that come and one that asks for their step, (R,).
    motions, contacts, events: records to work in; answers: RESPONSE records, filled, all (R, K).
    samples: those of kernels.py, filled, (R, K, 5, S), of which the force is of use. modes:
    the table of model/beam_modes.py that all runs share, or empty.
    """

    fastest: Array
    motions: Array
    contacts: Array
    events: Array
    answers: Array
    samples: Array
    modes: Array


class Further(NamedTuple):
    """The state of a run besides the beam's: beam, that of its model, and spheres (K,).

    nodes: theirs; forces: on them in this step (N); surplus: what the model's energy then has too
    much (J), (1,). run: its row of `fastest`; steps: number of its steps.
    """

    beam: Any
    fastest: Array
    run: int
    motions: Array
    contacts: Array
    events: Array
    samples: Array
    nodes: Array
    forces: Array
    surplus: Array
    steps: int


def make_table(cases: Array, samples: int) -> Table:
    """Return room for the further spheres of these cases, of which all have as many."""
    count = int(cases["further"][0])
    rows = cases["further_spheres"][:, :count]
    fastest, motions = cases.copy(), np.zeros(rows.shape[:2], MOTION)
    motions["velocity"], motions["delay"] = rows[..., 1], rows[..., 2]
    come = motions["delay"] <= cases["duration"][:, np.newaxis]
    fastest["further"] = come.sum(axis=1)
    # one contact takes at most the energy of all spheres
    squares = cases["velocity"] ** 2 + np.sum(come * rows[..., 1] ** 2, axis=1)
    fastest["velocity"] = np.where(come.any(axis=1), np.sqrt(squares), cases["velocity"])
    ends = (come & np.isin(rows[..., 0], (0.0, 1.0))).any(axis=1)
    fastest["strike_position"][ends] = 0.0  # half the mass to push
    return Table(
        fastest,
        motions,
        np.zeros(motions.shape, CONTACT),
        np.zeros(motions.shape, EVENTS),
        blank(motions.size).reshape(motions.shape),
        np.zeros((*motions.shape, 5, samples)),
        np.empty((0, 0)),
    )


@allocating  # what it returns counts its owners
def _join(state: State, table: Table, r: int, case: Record) -> Further:
    """Return the beam and the spheres of run r, before any touches it."""
    grid, count = state.grid, table.motions.shape[1]
    nodes = np.empty(count, dtype=np.int64)
    for k in range(count):
        contact, events = table.contacts[r, k], table.events[r, k]
        nodes[k] = grid.first - 1 + int(case.further_spheres[k, 0] * (case.nodes - 1) + 0.5)
        event_tracker.start(events, contact, 0)
        events.contacts = events.touching = 0.0
    return Further(
        state.extra,
        table.fastest,
        r,
        table.motions[r],
        table.contacts[r],
        table.events[r],
        table.samples[r],
        nodes,
        np.zeros(count),
        np.zeros(1),
        round(case.duration / grid.dt),
    )


@inlined
def _beam(state: State) -> State:
    """Return the state of the beam as its model has it."""
    pair, section, grid, beam, plastic, extra = state
    return State(pair, section, grid, beam, plastic, extra.beam)


@inlined
def _beam_at(state: State, node: int) -> State:
    """Return the same with another struck node."""
    pair, section, grid, beam, plastic, extra = state
    return State(pair, section, BeamGrid(node, *grid[1:]), beam, plastic, extra.beam)


@compiled
def _brought(state: State) -> float:
    motions, squares = state.extra.motions, 0.0
    for k in range(motions.size):
        squares += motions[k].begun * motions[k].velocity ** 2
    return float(0.5 * state.extra.fastest[state.extra.run].sphere_mass * squares)


def _presses(model: BeamModel) -> Any:
    """Return a function that takes a further sphere on by a step."""
    touch, sag, curvature = contact_of(model, True), model.sag, model.curvature

    @inlined
    def begin(state: State, k: int, now: int, t: float) -> None:
        """Let a sphere touch the beam t (s) before this step, or note where its struck face is."""
        pair, section, grid, beam, plastic = state[:5]
        i, dt, gravity = state.extra.nodes[k], grid.dt, state.extra.fastest[state.extra.run].gravity
        sphere, contact, events = (
            state.extra.motions[k],
            state.extra.contacts[k],
            state.extra.events[k],
        )
        face, shift = beam.w[now, i], 0.0
        if sag is not None:
            face += sag(_beam_at(state, i))
        if pair.bending != 0.0:
            elastic = plastic.M_0[i] / section.stiffness - curvature(_beam_at(state, i), now)
            shift = pair.bending * elastic
        face += shift
        if t >= 0.0:
            sphere.begun, contact.shift = 1, shift
            sphere.w_0 = face - t / dt * (face - sphere.face)
            sphere.w = sphere.w_0 + sphere.velocity * t + 0.5 * gravity * t * t
            sphere.v = sphere.velocity + gravity * (t - 0.5 * dt)
            events.w = events.w_before = events.w_max = beam.w[now, i]
            if sphere.w > face or t == 0.0:  # else the beam moves away
                events.contacts = events.touching = 1.0
        sphere.face = face

    @compiled
    def press(state: State, k: int, now: int) -> None:
        """Find the force of a sphere where a step begins, and move the sphere."""
        extra, dt = state.extra, state.grid.dt
        sphere, contact, events = extra.motions[k], extra.contacts[k], extra.events[k]
        case, step, w = extra.fastest[extra.run], sphere.step, state.beam.w[now, extra.nodes[k]]
        t = step * dt - sphere.delay
        sphere.step = step + 1
        if sphere.begun == 0:
            begin(state, k, now, t)
        if t < 0.0:
            return
        before, place = events.F, _beam_at(state, extra.nodes[k])
        F, approach, _ = touch(case, place, contact, events, now, sphere.w - w, t)
        sphere.v_before = sphere.v
        event_tracker.update_events(events, approach, contact.delta_r, w, F, sphere.v, t, dt)
        sphere.v += dt * (case.gravity - F / case.sphere_mass)
        sphere.w += dt * sphere.v
        extra.forces[k] = F
        samples = extra.samples[k]
        if samples.shape[1] > 0:
            start, end = (before, 0.0, 0.0, 0.0, 0.0), (F, 0.0, 0.0, 0.0, 0.0)
            fill_samples(samples, step, extra.steps, start, end)

    return press


def _reads(model: BeamModel) -> Any:
    """Return a function that reads the answers of further spheres."""
    lift = model.lift

    @compiled
    def read(state: State, case: Record, answer: Record, answers: Array) -> None:
        extra, pair, grid = state.extra, state.pair, state.grid
        for k in range(extra.motions.size):
            other, events, contact = answers[k], extra.events[k], extra.contacts[k]
            if answer.status & _WHOLE_RUN:
                other.status = answer.status & _WHOLE_RUN
                continue
            read_contact(other, events, contact, pair)
            read_inputs(other, case, contact, pair)
            if lift is not None:
                other.permanent_indentation += lift(_beam(state), contact, 0.0)
            read_rebound(other, case, events)
            place = (extra.nodes[k] - grid.first + 1) * grid.dx
            near = min(place, case.beam_span - place) < case.beam_depth
            answer.remarks |= other.remarks | (STRUCK_NEAR_END if near else 0)

    return read


def _leaps(model: BeamModel) -> Flight | None:
    """Return the leaps of a model, which end before a further sphere comes."""
    if model.flight is None:
        return None
    plain_leap, plain_retrace, plain_largest, plain_land = model.flight
    push: Any = model.push

    @inlined
    def leap(
        state: State, now: int, gap: float, sphere: tuple[float, float], w_max: float, room: int
    ) -> int:
        extra, dt = state.extra, state.grid.dt
        for k in range(extra.motions.size):
            other = extra.motions[k]
            if other.begun == 1:
                return 0
            room = min(room, math.ceil(other.delay / dt) - 1 - other.step)
        leapt = plain_leap(_beam(state), now, gap, sphere, w_max, room)
        if leapt > 0:
            push(_beam(state), 1 - now, extra.nodes, extra.forces)
            for k in range(extra.motions.size):
                extra.motions[k].step += leapt
        return leapt

    @compiled
    def retrace(state: State) -> tuple[float, float]:
        return plain_retrace(_beam(state))

    @inlined
    def largest(state: State, w_max: float) -> float:
        return plain_largest(_beam(state), w_max)

    @compiled
    def land(state: State, w: float) -> None:
        plain_land(_beam(state), w)

    return Flight(leap, retrace, largest, land)


def _touched(model: BeamModel) -> dict[str, Any]:
    """Return what else the contact of the first sphere asks of a model."""
    plain_sag, plain_beneath, plain_lift = model.sag, model.beneath, model.lift
    if plain_sag is None or plain_beneath is None or plain_lift is None:
        return {}

    @compiled
    def sag(state: State) -> float:
        return plain_sag(_beam(state))

    @compiled
    def beneath(state: State, now: int, F: float) -> float:
        return plain_beneath(_beam(state), now, F)

    @compiled
    def lift(state: State, contact: Record, F: float) -> float:
        return plain_lift(_beam(state), contact, F)

    return {"sag": sag, "beneath": beneath, "lift": lift}


def with_spheres(model: BeamModel) -> BeamModel:
    """Return a model of the beam that moves further spheres, too.

    Without prestress, whose kink is that of one contact.
    """
    model = model._replace(moments=None, bend_back=None)
    move_beam, plain_energy, plain_curvature = model.step, model.energy, model.curvature
    plain_deflect, plain_spread = model.deflect, model.spread
    plain_take: Any = model.take
    push: Any = model.push
    press = _presses(model)

    @inlined
    def step(state: State, now: int, F: float) -> None:
        extra, u = state.extra, state.beam.u
        for k in range(extra.motions.size):
            extra.motions[k].u_before = u[extra.nodes[k]]
            press(state, k, now)
        move_beam(_beam(state), now, F)
        extra.surplus[0] = push(_beam(state), now, extra.nodes, extra.forces)

    @compiled
    def curvature(state: State, now: int) -> float:
        return plain_curvature(_beam(state), now)

    @compiled
    def energy(state: State, now: int, F: float, u_mid: float) -> float:
        dt, extra, case = state.grid.dt, state.extra, state.extra.fastest[state.extra.run]
        total = plain_energy(_beam(state), now, F, u_mid) - extra.surplus[0]
        for k in range(extra.motions.size):
            sphere, events = extra.motions[k], extra.events[k]
            if sphere.begun == 1:
                stored, lost = energies(extra.contacts[k], state.pair, events.delta)
                fallen = sphere.w - dt * sphere.v - sphere.w_0
                square = sphere.v_before * sphere.v - sphere.velocity * sphere.velocity
                total += stored + lost
                total += case.sphere_mass * (0.5 * square - case.gravity * fallen)
                events.v_s, events.v_mid = sphere.v_before, sphere.u_before / dt
        return total

    @compiled
    def deflect(state: State, now: int) -> None:
        plain_deflect(_beam(state), now)

    @compiled
    def spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
        return plain_spread(_beam(state), now, F, a)

    @compiled
    def take(extra: Any, table: Table) -> None:
        plain_take(extra, table.modes)

    return model._replace(
        step=step,
        curvature=curvature,
        energy=energy,
        deflect=deflect,
        spread=spread,
        settle=None,
        flight=_leaps(model),
        take=None if plain_take is None else take,
        push=None,
        further=FurtherSpheres(_join, _reads(model), _brought),
        **_touched(model),
    )
