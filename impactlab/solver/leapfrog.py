"""The time loop: leapfrog (central differences), velocities at half steps.

m_s w_s'' = -F + m_s g, w_s(0) = 0, w_s'(0) = v0; indentation delta = w_s - w(L/2).

The paper's beam is moved in the loop itself, where that is fastest; the other models of the beam,
and the modal scheme, each by functions of its file.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver import event_tracker, responses
from impactlab.solver.beam import (
    Beam,
    Grid,
    bending_energy,
    kinetic_energy,
    make_beam,
    move,
    move_virgin,
    reach,
    strike,
)
from impactlab.solver.contact import history as contact_history
from impactlab.solver.contact.history import Pair, make_pair
from impactlab.solver.fibre_plasticity import (
    PlasticState,
    begin_tangents,
    catch_up,
    curvature,
    follow_tangents,
    leave_tangents,
    make_plastic_state,
    plastic_energy,
)
from impactlab.solver.jit import allocating, compiled
from impactlab.solver.lumped import Lumped, lumped_energy, lumped_step, make_lumped
from impactlab.solver.modal import (
    Modes,
    bend_sections,
    deflect,
    make_modes,
    modal_energy,
    mode_curvature,
    move_modes,
)
from impactlab.solver.outputs import DIVERGED, ENERGY_OUT_OF_BALANCE
from impactlab.solver.section import Section, make_section
from impactlab.solver.stability import discretise
from impactlab.solver.timoshenko import Shear, make_shear, shear_energy, shear_step
from impactlab.solver.types import (
    ELASTIC,
    LEAPFROG,
    MODAL,
    TIMOSHENKO,
    Array,
    Record,
)

_AUDITS = 500
_LEAST_STRIDE, _LARGEST_STRIDE = 16, 64
"""Energy is audited 500 times per run, but at most every 16 steps and at least every 64."""

WORST_ENERGY_ERROR = 0.05
"""Imbalance over the initial kinetic energy beyond which a run gives no other answer."""


class State(NamedTuple):
    """What a run marches: contact pair, section and grid, and the state of the beam.

    modes, shear and lumped are of the models and schemes beside the paper's; empty where a
    case needs none.
    """

    pair: Pair
    section: Section
    grid: Grid
    beam: Beam
    plastic: PlasticState
    modes: Modes
    shear: Shear
    lumped: Lumped


@compiled
def _sample(
    out: Array,
    step: int,
    steps: int,
    before: tuple[float, float, float, float, float],
    here: tuple[float, float, float, float, float],
) -> None:
    """Fill the samples of `out`, shape (5, samples), that fall into the step that ends here."""
    per_step = (out.shape[1] - 1) / steps
    k = max(math.ceil((step - 1) * per_step - 1e-9), 0)
    while k < out.shape[1] and k <= step * per_step * (1.0 + 1e-12):
        share = 1.0 - (step - k / per_step)
        for row in range(5):
            out[row, k] = before[row] + share * (here[row] - before[row])
        k += 1


@compiled
def _imbalance(
    case: Record,
    state: State,
    contact: Record,
    now: int,
    sphere: tuple[float, float, float, float],
    F: float,
    u_mid: float,
) -> float:
    """Return the energy missing or in excess, over the initial kinetic energy.

    After a step, of its beginning. sphere: its displacement (m), velocity before and after the step
    (m/s), indentation (m). u_mid (m): u at mid-span before the step.
    """
    w_s, v_before, v_after, delta = sphere
    start = 0.5 * case.sphere_mass * case.velocity**2
    falling = case.sphere_mass * (0.5 * v_before * v_after - case.gravity * w_s)
    beam, section, grid, M_0 = state.beam, state.section, state.grid, state.plastic.M_0
    stored, dissipated = plastic_energy(state.plastic, section, grid)
    if case.beam_model > TIMOSHENKO:
        in_beam = lumped_energy(beam, state.lumped, grid, now)
    elif case.beam_model == TIMOSHENKO:
        elastic = shear_energy(beam, state.shear, M_0, section.stiffness, grid)
        in_beam = stored + dissipated + elastic
    elif case.scheme == MODAL:
        q, u, _, D, push, source = state.modes[:6]
        in_beam = stored + dissipated + modal_energy(q, u, D, push, source, F)
    else:
        elastic = bending_energy(beam, M_0, section.stiffness, grid, now)
        moving = kinetic_energy(beam, grid, now, u_mid)
        in_beam = stored + dissipated + elastic + moving
    kept, lost = contact_history.energies(contact, state.pair, delta)
    return abs(falling + in_beam + kept + lost - start) / start


@compiled
def _mid_curvature(w: Array, now: int, psi: Array, q: Array, bent: Array, grid: Grid) -> float:
    """Return the curvature at mid-span in 1/m, of any model and scheme."""
    if q.size > 0:
        return mode_curvature(q, bent, grid.mid)
    return curvature(w, now, psi, grid, np.uint64(grid.mid))


@compiled
def _step(beam_model: int, state: State, now: int, F: float) -> None:
    """Move the beam of another model by one step."""
    _, section, grid, beam, plastic = state[:5]
    if beam_model == TIMOSHENKO:
        shear_step(beam, state.shear, plastic, section, grid, now, F)
    else:
        lumped_step(beam, state.lumped, grid, now, F)


@compiled
def _move_modes(
    state: State,
    q: Array,
    v: Array,
    D: Array,
    push: Array,
    source: Array,
    k2: Array,
    seen: Array,
    slack: Array,
    near: Array,
    F: float,
) -> float:
    """Move the modes and return the deflection at mid-span (m); a sixth faster apart from march."""
    if near[0] > 0 or slack[1] >= slack[0]:
        bend_sections(state.modes, state.plastic, state.section, state.grid)
    return move_modes(q, v, D, push, source, k2, seen, slack, F)


@compiled
def contact_force(
    contact: Record, events: Record, pair: Pair, delta: float, t: float, dt: float
) -> float:
    """Return the contact force (N) at time t; a peak just passed is taken between the steps."""
    falls = delta < events.delta and events.delta >= events.delta_before
    if falls and events.delta == contact.delta_m:
        offset, peak = event_tracker.vertex(events.delta_before, events.delta, delta)
        contact_history.load(contact, pair, peak)
        events.t_peak = t + (offset - 1.0) * dt
    return contact_history.force(contact, pair, delta)


@compiled
def march(
    case: Record, state: State, contact: Record, events: Record, samples: Array, steps: int
) -> int:
    """March from first touch to the end; return which row of beam.w is the last, or -1.

    -1: it diverged. contact and events are kept up to date.
    """
    pair, section, grid, beam, plastic_state = state[:5]
    w, u, plastic, psi = beam.w, beam.u, beam.plastic, state.shear.psi
    kappa_min, kappa_max, M_0 = plastic_state.kappa_min, plastic_state.kappa_max, plastic_state.M_0
    on_tangent, tangent = plastic_state.on_tangent, plastic_state.tangent
    q, v, k2, D, push, source, bent, seen, near, slack = state.modes
    paper = case.beam_model <= ELASTIC and case.scheme == LEAPFROG
    kappa_y, dt, mid = section.yield_curvature, grid.dt, grid.mid
    stride = min(max(_LEAST_STRIDE, steps // _AUDITS), _LARGEST_STRIDE)
    # half a step before the first touch
    w_s, v_s, per_mass = 0.0, case.velocity - 0.5 * dt * case.gravity, 1.0 / case.sphere_mass
    now = int(np.int64(0))  # a plain 0 would be a type of its own, and every callee compiled twice
    first, yielded, to_audit = mid, mid + 1, stride
    here = (0.0, 0.0, 0.0, 0.0, 0.0)
    contact.n = 1.5
    event_tracker.start(events)
    for step in range(steps + 1):
        w_mid, u_mid = w[now, mid], u[mid]
        delta = w_s - w_mid
        F = contact_force(contact, events, pair, delta, step * dt, dt)
        v_after = v_s + dt * (case.gravity - F * per_mass)
        event_tracker.update_events(events, delta, contact.delta_r, w_mid, F, v_s, step * dt, dt)
        if samples.shape[1] > 0:
            kappa = _mid_curvature(w, now, psi, q, bent, grid)
            before, here = here, (F, w_mid, kappa, w_s, delta)
            _sample(samples, step, steps, before, here)

        if paper:
            if on_tangent[0] > 0 and follow_tangents(
                w, now, psi, plastic, M_0, on_tangent, tangent, grid
            ):
                leave_tangents(beam, now, psi, plastic_state, section, grid)
            outside = move_virgin(w, now, u, first, yielded, grid, kappa_y)
            outside += move(w, now, u, plastic, kappa_min, kappa_max, yielded, grid)
            if outside > 0.0:
                outermost = begin_tangents(
                    beam, now, psi, outside, plastic_state, section, grid, u, w[1 - now]
                )
                yielded = min(yielded, max(outermost - 1, 2))
            strike(w, now, u, F, grid)
        elif q.size > 0:
            w[1 - now, mid] = _move_modes(state, q, v, D, push, source, k2, seen, slack, near, F)
            u[mid] = w[1 - now, mid] - w_mid
        else:
            _step(case.beam_model, state, now, F)

        to_audit -= 1
        if to_audit == 0 or step == steps:
            to_audit = stride
            catch_up(plastic_state, section)
            events.v_s, events.v_mid = v_s, u_mid / dt
            sphere = (w_s, v_s, v_after, delta)
            error = _imbalance(case, state, contact, now, sphere, F, u_mid)
            events.energy_error = max(events.energy_error, error)
            if not error < 1.0:
                return -1
        w_s, v_s, now = w_s + dt * v_after, v_after, 1 - now
        first = reach(w, now, first)
    return 1 - now


@allocating
def run_all(
    cases: Array,
    answers: Array,
    contacts: Array,
    events: Array,
    samples: Array,
    deflection: Array,
    plastic_strain: Array,
    peeq: Array,
) -> None:
    """Solve every case: R runs, by records and arrays of as many rows.

    cases: CASE records. answers: blank RESPONSE records, filled. contacts, events: zeros, CONTACT
    and EVENTS records to work in. samples: shape (R, 5, S), filled with force, mid-span
    deflection, mid-span curvature, sphere displacement and indentation at S equal intervals from 0
    to the duration; S = 0 for none. deflection (R, n + 1), plastic_strain and peeq
    (R, n + 1, P // 2): filled with the half beam's final state; length 0 for none. A run that
    diverges leaves NaN and its status.

    A record does not keep its array alive in compiled code, so kernels make no arrays of records:
    those of all runs are the caller's, who holds them until this returns.
    """
    for r in range(cases.size):
        case, answer = cases[r], answers[r]
        pair, section = make_pair(case), make_section(case)
        grid, steps = discretise(case, pair, section)
        state = State(
            pair,
            section,
            grid,
            make_beam(grid),
            make_plastic_state(grid, section),
            make_modes(
                case.nodes // 2 if case.scheme == MODAL else 0,
                grid,
                section.stiffness,
                section.yield_curvature,
            ),
            make_shear(case, grid.mid + 3 if case.beam_model == TIMOSHENKO else 0),
            make_lumped(case, section.stiffness, grid),
        )
        now = march(case, state, contacts[r], events[r], samples[r], steps)
        if now < 0:
            answer.status = DIVERGED
            samples[r] = np.nan
            continue
        answer.energy_error = events[r].energy_error
        if answer.energy_error > WORST_ENERGY_ERROR:
            answer.status = ENERGY_OUT_OF_BALANCE
        else:
            _, dissipated = plastic_energy(state.plastic, section, grid)
            responses.read_contact(answer, events[r], contacts[r], pair)
            responses.read_rebound(answer, case, events[r])
            responses.read_beam(answer, case, events[r], state.plastic.peeq, grid, dissipated)
        if case.scheme == MODAL and deflection.shape[1] > 0:
            deflect(state.modes, state.beam.w, now, grid.mid)
        # element by element: slices would compile the message of numpy's error, for seconds
        for i in range(deflection.shape[1]):
            deflection[r, i] = state.beam.w[now, i + 1]
            for j in range(peeq.shape[2]):
                plastic_strain[r, i, j] = state.plastic.plastic_strain[i + 1, j]
                peeq[r, i, j] = state.plastic.peeq[i + 1, j]
