"""The event tracker: peaks and contact events, interpolated between the steps."""

from collections.abc import Callable
from typing import Any

import numpy as np

from impactlab.solver.contact.history import Pair
from impactlab.solver.contact.switch import is_damped
from impactlab.solver.contact_damping import damped_force
from impactlab.solver.jit import compiled, inlined
from impactlab.solver.outputs import SHORT_PAUSE
from impactlab.solver.types import Record, record

EVENTS = record(
    """
    delta delta_before t_peak w w_before w_max F F_before contacts touching t_touch t_first_end
    time_in_contact v_exit v_s v_mid impulse energy_error before reloaded F_reloaded
    t_begin ledger
    """
)
"""At the last two steps: indentation delta, delta_before (m), mid-span deflection w, w_before (m),
force F (N); F_before (N) of laws with damping or strain rate. t_peak (s): time of the largest
force, which is that of the largest indentation but for these; w_max (m). contacts: number begun;
touching: 1 or 0; t_touch: when this contact began, t_begin: when the first one did, t_first_end:
when that ended (NaN: not yet), pauses shorter than SHORT_PAUSE of it left out, time_in_contact of
the ended ones (s); v_exit (m/s): the sphere's velocity when the last contact ended; v_s, v_mid
(m/s): of sphere and mid-span at the last audit. impulse (N s). energy_error: largest imbalance over
the initial energy, of all strikes. Of a further strike, before: how far the contact was loaded by
those before it (m; -1 in the first); reloaded (m), F_reloaded (N): the largest approach, and the
force at it, on the curve on which it reloads. ledger (J): what beam and contact have, by the
balance, when a strike ends."""


@compiled
def start(events: Record, contact: Record, strike: int) -> None:
    """Set the first touch of a strike: the sphere rests on the beam at t = 0."""
    if strike > 0:
        again(events, contact)
    else:
        events.before, contact.n = -1.0, 1.5
    events.contacts = 1.0
    events.touching = 1.0
    events.t_first_end = np.nan
    events.v_exit = np.nan
    events.t_peak = np.nan


@compiled
def again(events: Record, contact: Record) -> None:
    """Forget what happened in the strikes before, but for the energy and the contact's memory."""
    events.delta = events.delta_before = events.reloaded = contact.delta_r
    events.before, events.F_reloaded = contact.approach_m, 0.0
    events.F = events.F_before = contact.damping = 0.0
    events.t_touch = events.t_begin = events.time_in_contact = events.impulse = 0.0
    contact.peak_force, contact.largest = 0.0, 0.0


@compiled
def largest_load(events: Record, contact: Record) -> tuple[float, float]:
    """Return the largest force (N) and approach (m) of a strike, of laws that need no tracking."""
    if contact.approach_m > events.before:
        return contact.F_m, contact.approach_m
    return events.F_reloaded, events.reloaded


@compiled
def vertex(before: float, middle: float, after: float) -> tuple[float, float]:
    """Return (offset in steps from `middle`, value) of the extremum of a parabola by 3 points."""
    bend = before - 2.0 * middle + after
    if bend == 0.0:
        return 0.0, middle
    offset = 0.5 * (before - after) / bend
    return offset, middle - 0.25 * (before - after) * offset


def between_steps(
    load_to: Callable[..., Any], force: Callable[..., float], damped: bool = False
) -> Any:
    """Return the contact force of a law's two functions, a peak just passed between the steps.

    damped: also for laws with damping, or of the strain rate.
    """

    @inlined
    def contact_force(
        contact: Record, events: Record, pair: Pair, delta: float, t: float, dt: float
    ) -> float:
        """Return the contact force (N) at time t."""
        tracked = damped and (is_damped(pair.law) or pair.rate.D > 0.0)
        falls = delta < events.delta and events.delta >= events.delta_before
        if falls and events.delta == contact.approach_m:
            offset, peak = vertex(events.delta_before, events.delta, delta)
            largest = contact.peak_force
            load_to(contact, pair, peak)
            if not tracked or (pair.rate.D > 0.0 and contact.peak_force > largest):
                events.t_peak = t + (offset - 1.0) * dt
        elif falls and events.before >= 0.0 and events.delta > events.reloaded:
            offset, events.reloaded = vertex(events.delta_before, events.delta, delta)
            events.F_reloaded = force(contact, pair, events.reloaded)
            if not tracked:
                events.t_peak = t + (offset - 1.0) * dt
        F = force(contact, pair, delta)
        if damped and is_damped(pair.law):
            F = damped_force(contact, pair, F, delta, events.delta, events.delta_before, dt)
        if tracked:
            _note_peak(contact, events, F, t, dt)
        return F

    return contact_force


@compiled
def _note_peak(contact: Record, events: Record, F: float, t: float, dt: float) -> None:
    """Note a largest force just passed between the steps; F (N): at time t."""
    if events.F_before <= events.F and events.F > F:
        offset, peak = vertex(events.F_before, events.F, F)
        if peak > contact.peak_force:
            contact.peak_force, events.t_peak = peak, t + (offset - 1.0) * dt
    events.F_before = events.F


@inlined
def update_events(
    events: Record,
    delta: float,
    delta_r: float,
    w: float,
    F: float,
    v_s: float,
    t: float,
    dt: float,
) -> None:
    """Note what happened in the step that ends at t, and make it the last one."""
    gap_before, gap = delta_r - events.delta, delta_r - delta
    if events.touching == 1.0 and gap >= 0.0 and t > 0.0:  # a contact has ended
        end = t - dt * gap / (gap - gap_before)
        events.touching = 0.0
        events.time_in_contact += end - events.t_touch
        events.v_exit = v_s
        if np.isnan(events.t_first_end):
            events.t_first_end = end
    elif events.touching == 0.0 and gap < 0.0:  # a new one has begun
        events.t_touch = t - dt * gap / (gap - gap_before)
        events.touching = 1.0
        if events.time_in_contact == 0.0:  # the beam had moved away from the touch at t = 0
            events.t_begin, events.t_first_end, events.contacts = events.t_touch, np.nan, 0.0
        events.contacts += 1.0
        first = events.t_first_end - events.t_begin
        if events.t_touch - events.t_begin < (1.0 + SHORT_PAUSE) * first:
            events.t_first_end = np.nan
    if events.w > events.w_before and w <= events.w:  # a largest deflection lies between the steps
        _, value = vertex(events.w_before, events.w, w)
        events.w_max = max(events.w_max, value)
    events.impulse += 0.5 * dt * (events.F + F)
    events.delta_before, events.delta = events.delta, delta
    events.w_before, events.w = events.w, w
    events.F = F
