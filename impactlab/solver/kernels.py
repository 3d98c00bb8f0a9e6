"""The kernels, which solve many cases: one per model of the beam and scheme in time.

Each is compiled by itself, so that a study compiles only what it needs.
"""

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np

from impactlab.copies import Copies
from impactlab.solver import (
    BEAM_MODELS,
    FLOW_LAWS_OUTSIDE,
    RESISTANCES,
    euler_bernoulli,
    flow_stress,
    lumped,
    outputs,
    resistance,
    resisted_modes,
    responses,
    strip,
    von_karman,
)
from impactlab.solver.beam import half_node, make_beam, rest_beam
from impactlab.solver.contact import NUMBERED
from impactlab.solver.contact.history import make_pair
from impactlab.solver.contact.switch import DAMPED, substitutes
from impactlab.solver.fibre_plasticity import (
    keep_ends_elastic,
    make_plastic_state,
    plastic_energy,
    rest_plastic_state,
)
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.leapfrog import time_loop
from impactlab.solver.section import FibreSection, Room, cut_section, make_room, with_rate
from impactlab.solver.several_spheres import with_spheres
from impactlab.solver.stability import count_steps, divided, grid_of, struck_node
from impactlab.solver.state import BeamModel, State
from impactlab.solver.strikes import departure, resting, resting_once
from impactlab.solver.types import CONTACT_PATCH, MODAL, Array, Record

WORST_ENERGY_ERROR = 0.05
"""Imbalance over the initial kinetic energy beyond which a run gives no other answer."""


@allocating
def _section_at_rate(case: Record, fibres: Array, room: Room) -> FibreSection:
    return with_rate(cut_section(case, fibres, room), case)


@compiled
def _end_of_alike(cases: Array, start: int) -> int:
    """Return where the cases end that from `start` on need the same memory."""
    stop, first = start + 1, cases[start]
    last = grid_of(first, 1.0, 1.0, 1.0).last
    while stop < cases.size:
        case = cases[stop]
        if case.nodes != first.nodes or case.points != first.points:
            break
        ends = case.support_left != first.support_left, case.support_right != first.support_right
        if ends[0] or ends[1] or struck_node(case) != struck_node(first):
            break
        if grid_of(case, 1.0, 1.0, 1.0).last != last:  # springs alike, or not
            break
        stop += 1
    return stop


@compiled
def _keep_profiles(
    state: State,
    now: int,
    sunk: float,
    r: int,
    deflection: Array,
    plastic_strain: Array,
    peeq: Array,
) -> None:
    """Keep the beam's final state as that of run r, if it is asked for.

    sunk: how far the struck section lay below the beam as the last step began (m): punching.py.
    """
    # element by element: slices would compile the message of numpy's error, for seconds
    for i in range(deflection.shape[1]):
        node = half_node(state.grid, i)
        deflection[r, i] = state.beam.w[now, node]
        if node == state.grid.mid:
            deflection[r, i] += sunk
        for j in range(peeq.shape[2]):
            plastic_strain[r, i, j] = state.plastic.plastic_strain[node, j]
            peeq[r, i, j] = state.plastic.peeq[node, j]


def _run(model: BeamModel, extended: bool, rest: Callable[..., int]) -> Callable[..., int]:
    """Return a function that solves a case; rest: of `resting`, extended: see _kernel."""
    march, lift, leaves = time_loop(model, extended), model.lift, departure(model)
    largest_deflection = None if model.flight is None else model.flight.largest

    @inlined
    def run(
        case: Record,
        answer: Record,
        contact: Record,
        events: Record,
        samples: Array,
        series: Array,
        state: State,
        steps: int,
    ) -> int:
        """Solve a case from rest, and fill in its answer; see march for what is returned."""
        now = int(np.int64(0))
        for strike in range(case.strikes if extended else 1):
            if extended and strike > 0 and not leaves(state, events):
                answer.status = outputs.EARLIER_STRIKE_UNFINISHED
                return now
            interval = 0
            if extended and case.strike_interval > 0.0 and strike < case.strikes - 1:
                interval = max(round(case.strike_interval / state.grid.dt), steps + 1)
            now = march(case, state, contact, events, samples, steps, strike, interval, now)
            if largest_deflection is not None:
                events.w_max = largest_deflection(state, events.w_max)
            if now < 0:
                answer.status = outputs.DIVERGED
                return now
            if extended and case.strikes > 1:
                now = rest(case, answer, contact, events, series, state, strike, now)
        answer.energy_error = events.energy_error
        if answer.energy_error > WORST_ENERGY_ERROR:
            answer.status = outputs.ENERGY_OUT_OF_BALANCE
        else:
            pair, section, grid, plastic = state.pair, state.section, state.grid, state.plastic
            _, dissipated = plastic_energy(plastic, section, grid)
            responses.read_contact(answer, events, contact, pair)
            responses.read_inputs(answer, case, contact, pair)
            if lift is not None:
                answer.permanent_indentation += lift(state, contact, 0.0)
            responses.read_rebound(answer, case, events)
            responses.read_beam(
                answer, case, events, plastic.peeq, section.strain_ratio, grid, dissipated
            )
        return now

    return run


def _assembly(model: BeamModel) -> Callable[..., State]:
    """Return a function that makes the state of a run, with further spheres where there are any."""
    join = None if model.further is None else model.further.join

    @allocating  # others do not own the arrays that they return
    def assemble(state: State, table: Any, r: int, case: Record) -> State:
        """Return the state of run r; state: that of the beam and the first sphere."""
        if join is None:
            return state
        return State(*state[:5], join(state, table, r, case))

    return assemble


def _kernel(name: str, model: BeamModel, extended: bool = False) -> Callable[..., None]:
    """Return the kernel of a model of the beam.

    extended: with a load over the contact patch, strain rate, flow law, bending across the width,
    stress beneath the contact, damping of contact or beam, several strikes and the beam at rest
    after them. The plain kernel is free of these: it compiles sooner and is a tenth faster. Other
    models gain nothing by that.

    It solves every case of R, by records and arrays of as many rows. cases: CASE records. steps: as
    by count_steps. fibres: as by model.section.fibre_table. table: of modes, by model.beam_modes,
    which all cases share, or empty; with further spheres, that of several_spheres.py. answers:
    blank RESPONSE records, filled. contacts, events: zeros, CONTACT and EVENTS records to work in.
    samples: shape (R, 5, S), filled with force, mid-span deflection, mid-span curvature, sphere
    displacement and indentation at S equal intervals from 0 to the duration, of the last strike; S
    = 0 for none. series: shape (R, n, len(SERIES)), filled with outputs.SERIES of each of n
    strikes; n = 0 for none. deflection (R, nodes), plastic_strain and peeq (R, nodes, P // 2, or P
    with all fibres, outermost below first): filled with the beam's final state, at rest after
    several strikes; length 0 for none. A run that diverges leaves NaN and its status.
    """
    make, renew, take, deflect = model.make, model.renew, model.take, model.deflect
    assemble, read = _assembly(model), None if model.further is None else model.further.read
    rest = resting(model)
    run, rest_single = _run(model, extended, rest), resting_once(rest, extended)
    of_fibres = make_room, _section_at_rate if extended else cut_section
    make_section_room, cut = model.section or of_fibres

    def kernel(
        cases: Array,
        steps: Array,
        fibres: Array,
        table: Any,
        answers: Array,
        contacts: Array,
        events: Array,
        samples: Array,
        series: Array,
        deflection: Array,
        plastic_strain: Array,
        peeq: Array,
    ) -> None:
        stop = 0
        while stop < cases.size:
            start, first = stop, cases[stop]
            stop = _end_of_alike(cases, start)
            room, size = make_section_room(first), grid_of(first, 1.0, 1.0, 1.0)
            section = cut(first, fibres[start], room)
            beam, plastic = make_beam(size), make_plastic_state(size, section)
            extra = make(first, section, size)
            if take is not None:
                take(extra, table)
            for r in range(start, stop):
                case, pair = cases[r], make_pair(cases[r])
                section = cut(case, fibres[r], room)
                grid = divided(case, section.stiffness, steps[r])
                rest_beam(beam)
                rest_plastic_state(plastic, section)
                keep_ends_elastic(plastic, grid)
                if renew is not None:
                    renew(extra, case, section, grid)
                else:
                    extra = make(case, section, grid)
                alone = State(pair, section, grid, beam, plastic, extra)
                state = assemble(alone, table, r, case)
                answer, contact, event = answers[r], contacts[r], events[r]
                now = run(case, answer, contact, event, samples[r], series[r], state, steps[r])
                if read is not None:
                    read(state, case, answer, table.answers[r])
                if now < 0:
                    samples[r] = np.nan
                    continue
                if deflection.shape[1] > 0:
                    deflect(state, now)
                _keep_profiles(state, now, contact.sunk_before, r, deflection, plastic_strain, peeq)
                rest_single(case, answer, contact, event, series[r], state)

    kernel.__qualname__ = name
    return allocating(kernel)


_PLAIN = _kernel("euler_bernoulli", euler_bernoulli.MODEL)
_EULER_BERNOULLI = _kernel("extended_euler_bernoulli", resistance.MODEL, True)
_LUMPED = _kernel("lumped", lumped.MODEL, True)
_LEAPFROG = {
    "euler_bernoulli": _EULER_BERNOULLI,
    "elastic": _EULER_BERNOULLI,
    "timoshenko": _kernel("timoshenko", strip.MODEL, True),
    "von_karman": _kernel("von_karman", von_karman.MODEL, True),
    "spring_mass": _LUMPED,
    "rigid": _LUMPED,
}
_MODAL = _kernel("modal", resisted_modes.MODEL, True)
_SPHERES_ON_EULER_BERNOULLI = _kernel(
    "spheres_on_euler_bernoulli", with_spheres(resistance.MODEL), True
)
_SEVERAL = {
    "euler_bernoulli": _SPHERES_ON_EULER_BERNOULLI,
    "elastic": _SPHERES_ON_EULER_BERNOULLI,
    "timoshenko": _kernel("spheres_on_timoshenko", with_spheres(strip.MODEL), True),
    "von_karman": _kernel("spheres_on_von_karman", with_spheres(von_karman.MODEL), True),
}
_SEVERAL_MODAL = _kernel("spheres_modal", with_spheres(resisted_modes.MODEL), True)


def is_extended(cases: Array) -> Array:
    """Return which cases need what the plain kernel is free of; see _kernel."""
    extended = (cases["load"] == CONTACT_PATCH) | (cases["beam_rate_coefficient"] > 0.0)
    extended |= (cases["beam_rate_sensitivity"] > 0.0) | (cases["beam_flow_law"] > 0)
    extended |= cases["strikes"] > 1
    extended |= (cases["width_inertia"] > 0.0) | (cases["contact_prestress"] > 0)
    for name in RESISTANCES:
        extended |= cases[name] > 0.0
    for law in DAMPED:
        extended |= cases["contact"] == law
    for number, law in NUMBERED.items():
        if law.damping is not None:
            extended |= cases["contact"] == number
    return extended


def kernel_of(
    beam_model: int,
    scheme: int,
    extended: bool = False,
    several: bool = False,
    law: int = 0,
    flow_law: int = 0,
) -> Callable[..., None]:
    """Return the kernel for a beam model and a scheme, both as numbers.

    extended: see is_extended. several: whether of further spheres. law, flow_law: numbers of those
    from outside the package, which have kernels of their own; 0: all others.
    """
    model = BEAM_MODELS[beam_model]
    if scheme == MODAL:
        kernel = _SEVERAL_MODAL if several else _MODAL
    elif several:
        kernel = _SEVERAL[model]
    else:
        kernel = _LEAPFROG[model]
        if kernel is _EULER_BERNOULLI and not extended:
            kernel = _PLAIN
    return _with_laws(kernel, law, flow_law) if law or flow_law else kernel


_COPIES: dict[tuple[int, int], Copies] = {}
_COPYING = Lock()  # threads of one process share the copies


def step_counter(law: int = 0) -> Callable[..., None]:
    """Return the kernel that counts time steps, for a contact law from outside if not 0."""
    return _with_laws(count_steps, law, 0) if law else count_steps


def _with_laws(kernel: Callable[..., None], law: int, flow_law: int) -> Callable[..., None]:
    """Return the copy of a kernel, and of all that it calls, for laws from outside.

    Its functions are named by the hashes of the laws' sources: so are the files in which compiled
    code is kept, and linkers cannot mix them with those of another source.
    """
    substituted, hashes = [], []
    if law:
        substituted.append(substitutes(NUMBERED[law]))
        hashes.append(NUMBERED[law].source_hash)
    if flow_law:
        substituted.append(flow_stress.substitutes(FLOW_LAWS_OUTSIDE[flow_law]))
        hashes.append(FLOW_LAWS_OUTSIDE[flow_law].source_hash)
    suffix, numbers = "_".join(hashes), (law, flow_law)

    def finish(original: Any, copy: Any) -> Any:
        copy.__qualname__ = f"{copy.__qualname__.replace('<locals>.', '')}_{suffix}"
        return getattr(original, "decorate", compiled)(copy)

    with _COPYING:
        if numbers not in _COPIES:
            copies = Copies(finish)
            for links in substituted:
                for function, substitute in links.items():
                    copies.put(function, copies.of(substitute))
            _COPIES[numbers] = copies
        copied: Callable[..., None] = _COPIES[numbers].of(kernel)
    return copied
