"""Further spheres: what comes of them from outside the kernels, and their state in a run."""

import math
from typing import Any, NamedTuple

import numpy as np

from impactlab.solver import event_tracker
from impactlab.solver.contact.history import CONTACT, energies
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.jit import allocating, compiled
from impactlab.solver.outputs import blank
from impactlab.solver.responses import sphere_leaves
from impactlab.solver.state import State
from impactlab.solver.types import Array, Record, record

MOTION = record("velocity delay v v_before w w_0 u_before face ahead spent", integers="step begun")
"""Of a sphere: velocity (m/s) at first touch, delay (s); v, v_before (m/s): after and before the
step; w (m): displacement after it, counted as the beam's deflection, w_0: at first touch. u_before
(m): u of its node before the step, face: where the struck face was a step ago, before the touch.
ahead (m): of the mean under the pressure, of its node. spent (J): what the contact has kept and
lost in the strikes before.
step: number of steps made; begun: COMING, TOUCHED once it has touched the beam, and then AWAY when
it is taken away, or MISSED when it is before."""
MISSED, COMING, TOUCHED, AWAY = -1, 0, 1, 2
_MANY_STEPS = 2**62


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


class Further(NamedTuple):
    """The state of a run besides the beam's: beam, that of its model, and spheres (K,).

    nodes: theirs; forces: on them in this step (N); surplus: what the model's energy then has too
    much (J), (1,). kink: of the first sphere (rad), (1,); rise: how far those of the others raise
    the nodes (m), (last + 3,). run: its row of `fastest`; steps: number of its steps.
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
    kink: Array
    rise: Array
    steps: int


@allocating  # what it returns counts its owners
def join(state: State, table: Table, r: int, case: Record) -> Further:
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
        np.zeros(1),
        np.zeros(grid.last + 3),
        round(case.duration / grid.dt),
    )


@compiled
def rise(state: State) -> float:
    """Return how far the kinks of further spheres raise the struck node (m)."""
    return float(state.extra.rise[state.grid.mid])


@compiled
def leave(state: State) -> bool:
    """Return whether all that have touched the beam move away."""
    for k in range(state.extra.motions.size):
        if state.extra.motions[k].begun == TOUCHED and not sphere_leaves(state.extra.events[k]):
            return False
    return True


@compiled
def brought(state: State) -> float:
    """Return the kinetic energy (J) with which those came that have touched the beam."""
    motions, squares = state.extra.motions, 0.0
    for k in range(motions.size):
        squares += (motions[k].begun > COMING) * motions[k].velocity ** 2
    return float(0.5 * state.extra.fastest[state.extra.run].sphere_mass * squares)


@compiled
def balance(state: State, k: int) -> tuple[float, float]:
    """Return what a contact has kept and lost in this strike, and what its sphere gained (J)."""
    extra, dt = state.extra, state.grid.dt
    sphere, case = extra.motions[k], extra.fastest[extra.run]
    stored, lost = energies(extra.contacts[k], state.pair, extra.events[k].delta)
    fallen = sphere.w - dt * sphere.v - sphere.w_0
    square = sphere.v_before * sphere.v - sphere.velocity * sphere.velocity
    gained = case.sphere_mass * (0.5 * square - case.gravity * fallen)
    return stored + lost - sphere.spent, gained


@compiled
def work(state: State) -> float:
    """Return what the spheres have given to the beam in this strike (J)."""
    total = 0.0
    for k in range(state.extra.motions.size):
        if state.extra.motions[k].begun > COMING:
            in_contact, gained = balance(state, k)
            total -= in_contact + gained
    return total


@compiled
def have_touched(motions: Array) -> bool:
    """Return whether a further sphere that has touched the beam is there."""
    number = 0
    for k in range(motions.size):
        number += motions[k].begun == TOUCHED
    return number > 0


@compiled
def steps_alone(motions: Array, dt: float) -> int:
    """Return the number of steps of dt (s) before a further sphere comes."""
    least = _MANY_STEPS
    for k in range(motions.size):
        if motions[k].begun == COMING:
            least = min(least, math.ceil(motions[k].delay / dt) - 1 - motions[k].step)
    return least


@compiled
def take_away(state: State) -> None:
    """Take all spheres away, also those that have not come yet."""
    extra = state.extra
    for k in range(extra.motions.size):
        extra.motions[k].begun = AWAY if extra.motions[k].begun == TOUCHED else MISSED
        extra.forces[k] = 0.0


@compiled
def again(state: State, strike: int) -> None:
    """Let all spheres come again, once so many strikes are over."""
    extra = state.extra
    extra.surplus[0] = 0.0
    for k in range(extra.motions.size):
        sphere, contact, events = extra.motions[k], extra.contacts[k], extra.events[k]
        sphere.step, sphere.begun = 0, COMING
        sphere.ahead = 0.0
        stored, lost = energies(contact, state.pair, contact.delta_r)
        sphere.spent = stored + lost
        event_tracker.start(events, contact, strike)
        events.contacts = events.touching = 0.0
        for j in range(extra.samples.shape[2]):
            extra.samples[k, 0, j] = 0.0
