"""Several spheres on one beam, of any model and scheme that can be pushed beside its struck node.

The time loop (leapfrog.py) moves the first sphere; for it, the others are a part of the beam. Each
touches the beam at its node after its delay, whatever the beam does by then:

    m_s w_s'' = -F + m_s g,  w_s = w, w_s' = v at the delay;  F of w_s - w by the contact law.

Its contact is that of the time loop, in whose grid its node is the struck one: local compliance and
a strip's bending across are those there. A delay falls between two steps: w there is that of a
straight line, and the sphere moves as without a force until the later of them, an error of second
order in the step. Spheres are alike and undented, and their contacts know of each other through the
beam alone. Each kink (kink.py) is of one contact, and the beam deflects beyond all of them. In
repeated strikes all spheres come again, each to its dent; before the beam is struck while it still
moves, they are taken away once they have left, as the first one is.

The balance of energy has what each sphere has lost since its touch, and what its contact holds.
Leaps (flight.py) are made until the first of these spheres comes.
"""

from typing import Any

from impactlab.solver import event_tracker, kink
from impactlab.solver.beam import BeamGrid
from impactlab.solver.contact_patch import contact_radius
from impactlab.solver.jit import compiled, inlined
from impactlab.solver.leapfrog import contact_of, fill_samples
from impactlab.solver.outputs import (
    DIVERGED,
    EARLIER_STRIKE_UNFINISHED,
    ENERGY_OUT_OF_BALANCE,
    STRUCK_NEAR_END,
)
from impactlab.solver.responses import read_contact, read_inputs, read_rebound
from impactlab.solver.sphere_table import (
    AWAY,
    COMING,
    MISSED,
    TOUCHED,
    Table,
    again,
    balance,
    brought,
    have_touched,
    join,
    leave,
    rise,
    steps_alone,
    take_away,
    work,
)
from impactlab.solver.state import BeamModel, Flight, FurtherSpheres, State
from impactlab.solver.types import CONTACT_PATCH, Array, Record

_WHOLE_RUN = DIVERGED | ENERGY_OUT_OF_BALANCE | EARLIER_STRIKE_UNFINISHED


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


@inlined
def _deflection(state: State, now: int, i: int) -> float:
    """Return the deflection (m) of node i, without the kinks that it counts from."""
    extra = state.extra
    return float(
        state.beam.w[now, i] - extra.rise[i] - kink.height_of(state.grid, extra.kink[0], i)
    )


@compiled
def _raise(state: State, grid: BeamGrid, growth: float) -> None:
    """Note that a kink at a grid's struck node has grown (rad)."""
    for i in range(1, grid.stop + 1 if growth > 0.0 else 1):
        state.extra.rise[i] += kink.height_of(grid, growth, i)


def _presses(model: BeamModel) -> Any:
    """Return a function that takes a further sphere on by a step."""
    touch, sag, curvature = contact_of(model, True), model.sag, model.curvature

    @inlined
    def begin(state: State, k: int, now: int, t: float) -> None:
        """Let a sphere touch the beam t (s) before this step, or note where its struck face is."""
        pair, section, grid, _, plastic = state[:5]
        i, dt, gravity = state.extra.nodes[k], grid.dt, state.extra.fastest[state.extra.run].gravity
        sphere, contact, events = (
            state.extra.motions[k],
            state.extra.contacts[k],
            state.extra.events[k],
        )
        w = _deflection(state, now, i) + contact.sunk
        face, shift = w + contact.delta_r, 0.0
        if sag is not None:
            face += sag(_beam_at(state, i))
        if pair.bending != 0.0:
            elastic = plastic.M_0[i] / section.stiffness - curvature(_beam_at(state, i), now)
            shift = pair.bending * elastic
        face += shift
        if t >= 0.0:
            sphere.begun, contact.shift = TOUCHED, shift
            sphere.w_0 = face - t / dt * (face - sphere.face)
            sphere.w = sphere.w_0 + sphere.velocity * t + 0.5 * gravity * t * t
            sphere.v = sphere.velocity + gravity * (t - 0.5 * dt)
            events.w = events.w_before = events.w_max = w
            if sphere.w > face or t == 0.0:  # else the beam moves away
                events.contacts = events.touching = 1.0
        sphere.face = face

    @compiled
    def press(state: State, k: int, now: int) -> None:
        """Find the force of a sphere where a step begins, and move the sphere."""
        extra, dt = state.extra, state.grid.dt
        sphere, contact, events = extra.motions[k], extra.contacts[k], extra.events[k]
        case, step = extra.fastest[extra.run], sphere.step
        t = step * dt - sphere.delay
        sphere.step = step + 1
        if sphere.begun == COMING:
            begin(state, k, now, t)
        if t < 0.0:
            return
        before, place = events.F, _beam_at(state, extra.nodes[k])
        w, bent = _deflection(state, now, extra.nodes[k]) + contact.sunk, contact.kink
        F, approach, _ = touch(case, place, contact, events, now, sphere.w - w - sphere.ahead, t)
        _raise(state, place.grid, contact.kink - bent)
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
        for i in range(extra.rise.size):  # of the deflection beyond kinks, that of the beam
            state.beam.w[0, i] -= extra.rise[i]
            state.beam.w[1, i] -= extra.rise[i]

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
        if have_touched(extra.motions):
            return 0
        room = min(room, steps_alone(extra.motions, dt))
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

    plain_moments, plain_bend_back = model.moments, model.bend_back
    if plain_moments is None or plain_bend_back is None:
        return {"sag": sag, "beneath": beneath, "lift": lift}

    @compiled
    def moments(state: State, now: int) -> tuple[float, float]:
        return plain_moments(_beam(state), now)

    @compiled
    def bend_back(state: State, now: int, contact: Record, growth: float) -> None:
        plain_bend_back(_beam(state), now, contact, growth)
        state.extra.kink[0] = contact.kink

    touched = {"sag": sag, "beneath": beneath, "lift": lift}
    return touched | {"moments": moments, "bend_back": bend_back}


def _energies(model: BeamModel) -> Any:
    """Return the function of a model's energy, with that of further spheres."""
    plain_energy = model.energy

    @compiled
    def energy(state: State, now: int, F: float, u_mid: float) -> float:
        extra = state.extra
        total = plain_energy(_beam(state), now, F, u_mid) - extra.surplus[0]
        for k in range(extra.motions.size):
            sphere, events = extra.motions[k], extra.events[k]
            if sphere.begun > COMING:
                in_contact, gained = balance(state, k)
                total += in_contact
                total += gained
                events.v_s, events.v_mid = sphere.v_before, sphere.u_before / state.grid.dt
        return total

    return energy


def _spreads(model: BeamModel) -> Any:
    """Return a function that spreads the forces of further spheres, None of modes."""
    plain_spread = model.spread
    if model.flight is not None:
        return None

    @compiled
    def spread_forces(state: State, now: int) -> None:
        """Spread the forces over the circles of contact."""
        extra, u = state.extra, state.beam.u
        for k in range(extra.motions.size):
            i, F, pushed = extra.nodes[k], extra.forces[k], u[extra.nodes[k]]
            if F > 0.0:
                a = contact_radius(extra.contacts[k], state.pair, F)
                change, excess = plain_spread(_beam_at(state, i), now, F, a)
                extra.motions[k].ahead += change
                if excess != 0.0:  # the energy knows nothing of it, as of `surplus`
                    extra.surplus[0] += 0.5 * F * (u[i] + change - pushed)

    return spread_forces


def _settles(model: BeamModel) -> Any:
    """Return a function that puts the beam to rest with the nodes of further spheres."""
    plain_settle, push, flies = model.settle, model.push, model.flight is not None
    if plain_settle is None or push is None:
        return None

    @compiled
    def settle(state: State) -> None:
        plain_settle(_beam(state))
        if flies:  # of modes, the nodes follow
            for k in range(state.extra.motions.size):
                state.extra.forces[k] = 0.0
            for now in range(2):
                push(_beam(state), now, state.extra.nodes, state.extra.forces)

    return settle


def _rest_remarks(model: BeamModel) -> Any:
    """Return a function that gives the bits of remarks on the beam at rest, None of most."""
    plain_rest_remarks = model.rest_remarks
    if plain_rest_remarks is None:
        return None

    @compiled
    def rest_remarks(state: State) -> int:
        return int(plain_rest_remarks(_beam(state)))

    return rest_remarks


def with_spheres(model: BeamModel) -> BeamModel:
    """Return a model of the beam that moves further spheres, too."""
    move_beam, plain_curvature = model.step, model.curvature
    plain_deflect, plain_spread = model.deflect, model.spread
    plain_take: Any = model.take
    push: Any = model.push
    press, spread_forces = _presses(model), _spreads(model)

    @inlined
    def step(state: State, now: int, F: float) -> None:
        extra, u = state.extra, state.beam.u
        for k in range(extra.motions.size):
            extra.motions[k].u_before = u[extra.nodes[k]]
            if extra.motions[k].begun not in (AWAY, MISSED):
                press(state, k, now)
        move_beam(_beam(state), now, F)
        extra.surplus[0] = push(_beam(state), now, extra.nodes, extra.forces)
        if spread_forces is not None and extra.fastest[extra.run].load == CONTACT_PATCH:
            spread_forces(state, now)

    @compiled
    def curvature(state: State, now: int) -> float:
        return plain_curvature(_beam(state), now)

    @compiled
    def deflect(state: State, now: int) -> None:
        plain_deflect(_beam(state), now)
        for k in range(state.extra.nodes.size):
            state.beam.w[now, state.extra.nodes[k]] += state.extra.contacts[k].sunk_before

    @compiled
    def spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
        return plain_spread(_beam(state), now, F, a)

    @compiled
    def take(extra: Any, table: Table) -> None:
        plain_take(extra, table.modes)

    return model._replace(
        step=step,
        curvature=curvature,
        energy=_energies(model),
        deflect=deflect,
        spread=spread,
        settle=_settles(model),
        rest_remarks=_rest_remarks(model),
        flight=_leaps(model),
        take=None if plain_take is None else take,
        push=None,
        further=FurtherSpheres(join, _reads(model), brought, rise, leave, take_away, work, again),
        **_touched(model),
    )
