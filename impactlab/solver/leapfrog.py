"""The time loop: leapfrog (central differences), velocities at half steps.

m_s w_s'' = -F + m_s g, w_s(0) = 0, w_s'(0) = v0; indentation delta = w_s - w(L/2), or against the
mean under the contact's pressure (contact_patch.py).
"""

import math
from collections.abc import Callable

import numpy as np

from impactlab.solver import event_tracker, kink, punching
from impactlab.solver.contact import history as contact_history
from impactlab.solver.contact import prestress, rate
from impactlab.solver.contact_patch import contact_radius
from impactlab.solver.fibre_plasticity import catch_up
from impactlab.solver.jit import compiled, inlined
from impactlab.solver.state import BeamModel, Flight, State
from impactlab.solver.strikes import departure
from impactlab.solver.types import CONTACT_PATCH, Array, Record

_AUDITS = 500
_LEAST_STRIDE, _LARGEST_STRIDE = 16, 64
"""Energy is audited 500 times per run, but at most every 16 steps and at least every 64."""
_AWAY = 1e15
"""Distance (m) of a sphere that has left, while the beam goes on."""

Point = tuple[float, float, float, float, float]
"""Force, mid-span deflection and curvature, sphere displacement and indentation at a step."""


@compiled
def fill_samples(
    out: Array,
    step: int,
    steps: int,
    before: Point,
    after: Point,
) -> None:
    """Fill the samples of `out`, shape (5, samples), that fall into the step that ends here."""
    per_step = (out.shape[1] - 1) / steps
    k = max(math.ceil((step - 1) * per_step - 1e-9), 0)
    while k < out.shape[1] and k <= step * per_step * (1.0 + 1e-12):
        share = 1.0 - (step - k / per_step)
        for row in range(5):
            out[row, k] = before[row] + share * (after[row] - before[row])
        k += 1


contact_force = event_tracker.between_steps(contact_history.load_to, contact_history.force)
damped_force = event_tracker.between_steps(
    contact_history.load_to, contact_history.force, damped=True
)
prestressed_force = event_tracker.between_steps(prestress.force, prestress.force, damped=True)


def _leaps(flight: Flight) -> Callable[..., tuple[int, Point]]:
    """Return a function that leaps over steps without contact, if it can, and samples them."""
    leap, retrace, _, _ = flight

    @inlined
    def fly(
        state: State,
        now: int,
        contact: Record,
        events: Record,
        samples: Array,
        sphere: tuple[float, float, float, float],
        step: int,
        steps: int,
        end: int,
        point: Point,
    ) -> tuple[int, Point]:
        """Return (number of steps, last point sampled).

        sphere: its displacement, its last step, how much each grows by, and indentation (m). steps:
        number of steps that are sampled; end: the last step.
        """
        w_s, last, fall, delta = sphere
        w_mid = state.beam.w[now, state.grid.mid]
        gap = contact.delta_r - delta
        leapt = leap(state, now, gap, (last, fall), events.w_max, end - step)
        for j in range(1, leapt if samples.shape[1] > 0 and step < steps else 0):
            w, kappa = retrace(state)
            moved = j * (last + 0.5 * (j + 1) * fall)
            before, point = point, (0.0, w, kappa, w_s + moved, delta + moved - (w - w_mid))
            fill_samples(samples, step + j, steps, before, point)
        return leapt, point

    return fly


def _struck(model: BeamModel) -> Callable[..., float]:
    """Return a function that gives the deflection (m) of the struck section, without kinks."""
    rise = None if model.further is None else model.further.rise

    @inlined
    def struck(state: State, contact: Record, now: int) -> float:
        w_mid = state.beam.w[now, state.grid.mid] - kink.height(state.grid, contact.kink)
        w_mid += contact.sunk
        return float(w_mid if rise is None else w_mid - rise(state))

    return struck


def _touch_down(model: BeamModel) -> Callable[..., tuple[float, float]]:
    """Return a function that begins a strike."""
    beam_energy, mid_curvature, sag = model.energy, model.curvature, model.sag
    fast, land = model.flight is not None, None if model.flight is None else model.flight.land
    struck = _struck(model)
    again = None if model.further is None else model.further.again

    @compiled
    def touch_down(
        case: Record, state: State, contact: Record, events: Record, strike: int, now: int
    ) -> tuple[float, float]:
        """Return the sphere's displacement (m), and the whole energy (J) but for its velocity's.

        At first touch, where a beam that was struck before is at rest, or moves on: then its energy
        is that of the balance of the strikes before.
        """
        event_tracker.start(events, contact, strike)
        if strike == 0:
            return 0.0, 0.0
        pair, section, grid, beam, plastic = state[:5]
        w_mid = struck(state, contact, now)
        if again is not None:
            again(state, strike)
        events.w = events.w_before = events.w_max = w_mid
        w_s = w_mid + contact.delta_r
        if pair.bending != 0.0:
            elastic = plastic.M_0[grid.mid] / section.stiffness - mid_curvature(state, now)
            w_s += pair.bending * elastic
        if sag is not None:
            w_s += sag(state)
        if case.strike_interval > 0.0:
            if land is not None:
                land(state, beam.w[now, grid.mid])
            return w_s, events.ledger - case.sphere_mass * case.gravity * w_s
        stored, lost = contact_history.energies(contact, pair, contact.delta_r, fast)
        in_beam = beam_energy(state, 0, 0.0, 0.0)
        return w_s, in_beam + stored + lost - case.sphere_mass * case.gravity * w_s

    return touch_down


def _taking_away(model: BeamModel) -> Callable[..., int]:
    """Return a function that takes the spheres away between two strikes on the moving beam."""
    leaves = departure(model)
    work = None if model.further is None else model.further.work
    others_away = None if model.further is None else model.further.take_away

    @compiled
    def take_away(
        case: Record,
        state: State,
        events: Record,
        sphere: tuple[float, float, float, float],
        v_mid: float,
        energy: float,
        step: int,
        steps: int,
        end: int,
        interval: int,
    ) -> int:
        """Take spheres away that have left, `steps` after the first came; return the last step.

        sphere, energy: see _audit. v_mid: of the struck node (m/s). end: the last step so far.
        """
        w_s, v_s, v_after, _ = sphere
        if step <= steps:
            events.v_s, events.v_mid = v_s, v_mid
        if step == end:
            spent = 0.5 * case.sphere_mass * (case.velocity**2 - v_s * v_after)
            events.ledger = energy + spent + case.sphere_mass * case.gravity * w_s
            if work is not None:
                events.ledger += work(state)
        if step == steps and interval > 0 and leaves(state, events):
            events.w_max = _AWAY
            if others_away is not None:
                others_away(state)
            return max(interval - 1, steps)
        return end

    return take_away


def _audit(model: BeamModel) -> Callable[..., bool]:
    """Return the audit of the energy of a model of the beam."""
    beam_energy, fast = model.energy, model.flight is not None
    brought = None if model.further is None else model.further.brought

    @inlined
    def audit(
        case: Record,
        state: State,
        contact: Record,
        events: Record,
        now: int,
        sphere: tuple[float, float, float, float],
        F: float,
        u_mid: float,
        excess: float,
        at_touch: float,
    ) -> bool:
        """Return whether the energy missing or in excess is below that of spheres that touched.

        Their kinetic energy, over which the largest error is kept. After a step, of its beginning,
        with fibres brought up to date. sphere: its displacement (m), velocity before and after the
        step (m/s), approach (m). u_mid (m): u at mid-span before the step. excess (J): see
        BeamModel.spread. at_touch (J): the energy at the strike's beginning, without the sphere's.
        """
        w_s, v_before, v_after, approach = sphere
        catch_up(state.plastic, state.section)
        start = 0.5 * case.sphere_mass * case.velocity**2
        falling = case.sphere_mass * (0.5 * v_before * v_after - case.gravity * w_s)
        in_beam = beam_energy(state, now, F, u_mid) + excess
        kept, lost = contact_history.energies(contact, state.pair, approach, fast)
        missing = abs(falling + in_beam + kept + lost - (start + at_touch))
        error = missing / start if brought is None else missing / (start + brought(state))
        events.energy_error = max(events.energy_error, error)
        return bool(error < 1.0)

    return audit


def contact_of(model: BeamModel, extended: bool) -> Callable[..., tuple[float, float, float]]:
    """Return the contact of a sphere with a model of the beam; extended: see kernels.py."""
    mid_curvature, sag, beneath = model.curvature, model.sag, model.beneath
    lift, moments, bend_back = model.lift, model.moments, model.bend_back
    force = damped_force if extended else contact_force

    @inlined
    def touch(
        case: Record,
        state: State,
        contact: Record,
        events: Record,
        now: int,
        delta: float,
        t: float,
    ) -> tuple[float, float, float]:
        """Return the contact force (N), the approach and the indentation (m) at time t.

        delta (m): how much further the sphere has moved than the beam under it.
        """
        pair, section, grid, _, plastic = state[:5]
        if sag is not None:
            delta -= sag(state)
        approach = delta
        if pair.bending != 0.0:
            contact.shift_before = contact.shift
            elastic = plastic.M_0[grid.mid] / section.stiffness - mid_curvature(state, now)
            contact.shift = pair.bending * elastic
            approach = delta - contact.shift
        if extended and pair.rate.D > 0.0:
            rate.strain(contact, pair, approach, grid.dt)
        if moments is not None and bend_back is not None and pair.prestress[0] > 0.0:
            along, across = moments(state, now)
            contact.stress_along = case.stress_per_moment * along
            contact.stress_across = case.stress_per_moment * across
            F = prestressed_force(contact, events, pair, approach, t, grid.dt)
            bend_back(state, now, contact, kink.growth(case, contact, pair))
            punching.punch(case, contact, pair, F, events.F)
        elif extended and pair.rate.D > 0.0:
            furthest, before = contact.approach_m, rate.curve_of(contact)
            F = force(contact, events, pair, approach, t, grid.dt)
            if contact.approach_m > furthest:
                rate.dissipate(contact, before)
        else:
            F = force(contact, events, pair, approach, t, grid.dt)
        if beneath is not None and lift is not None:
            delta += lift(state, contact, F) - beneath(state, now, F)
        if pair.bending != 0.0:
            contact.largest = max(contact.largest, delta)
            grown = contact.shift - contact.shift_before
            contact.bending_work += 0.5 * (F + events.F) * grown
        return F, approach, delta

    return touch


def time_loop(model: BeamModel, extended: bool) -> Callable[..., int]:
    """Return the time loop of a model of the beam; extended: see kernels.py."""
    move_beam, mid_curvature, spread = model.step, model.curvature, model.spread
    flight_stride, fly = model.flight_stride, None if model.flight is None else _leaps(model.flight)
    touch, touch_down, audit = contact_of(model, extended), _touch_down(model), _audit(model)
    take_away, struck = _taking_away(model), _struck(model)

    @inlined
    def march(
        case: Record,
        state: State,
        contact: Record,
        events: Record,
        samples: Array,
        steps: int,
        strike: int,
        interval: int,
        now: int,
    ) -> int:
        """March from first touch to the end; return the last row of beam.w, or -1: it diverged.

        contact and events are kept up to date. strike: how many came before. interval: number of
        steps until the next on the moving beam, with the sphere taken away once `steps` are over,
        if it leaves; 0: none follows. now: the first row.
        """
        pair, grid, beam = state.pair, state.grid, state.beam
        w, u, dt, mid = beam.w, beam.u, grid.dt, grid.mid
        stride = min(max(_LEAST_STRIDE, steps // _AUDITS), _LARGEST_STRIDE)
        # half a step before the first touch
        v_s, per_mass = case.velocity - 0.5 * dt * case.gravity, 1.0 / case.sphere_mass
        w_s, rest = touch_down(case, state, contact, events, strike, now)
        # a plain 0 would be a type of its own, and its callees compiled twice
        step = int(np.int64(0))
        to_audit, end = stride, steps
        here, ahead = (0.0, 0.0, 0.0, 0.0, 0.0), 0.0  # the mean under the pressure, of mid-span
        while step <= end:
            t, u_mid = step * dt, u[mid]
            w_mid = struck(state, contact, now)
            F, approach, delta = touch(case, state, contact, events, now, w_s - w_mid - ahead, t)
            v_after = v_s + dt * (case.gravity - F * per_mass)
            event_tracker.update_events(events, approach, contact.delta_r, w_mid, F, v_s, t, dt)
            if samples.shape[1] > 0:
                before, here = here, (F, w_mid, mid_curvature(state, now), w_s, delta)
                fill_samples(samples, step, steps, before, here)

            if fly is not None and events.touching == 0.0 and F == 0.0 and pair.bending == 0.0:
                sphere = (w_s, dt * v_s, dt * dt * case.gravity, delta)
                leapt, here = fly(
                    state, now, contact, events, samples, sphere, step, steps, end, here
                )
                if leapt > 0:
                    w_s += leapt * (sphere[1] + 0.5 * (leapt + 1) * sphere[2])
                    v_s, step = v_s + leapt * dt * case.gravity, step + leapt
                    to_audit = max(to_audit - leapt, 1)
                    events.w = events.w_before = w[now, mid] - u[mid]
                    events.delta = events.delta_before = w_s - dt * v_s - events.w - ahead
                    continue

            move_beam(state, now, F)
            excess = 0.0
            if extended and case.load == CONTACT_PATCH and F > 0.0:
                change, excess = spread(state, now, F, contact_radius(contact, pair, F))
                ahead += change
            to_audit = min(to_audit - 1, stride) if F > 0.0 else to_audit - 1
            if to_audit == 0 or step == end:
                to_audit = max(stride, flight_stride)
                sphere = (w_s, v_s, v_after, approach)
                if not audit(case, state, contact, events, now, sphere, F, u_mid, excess, rest):
                    return -1
                end = take_away(
                    case, state, events, sphere, u_mid / dt, rest, step, steps, end, interval
                )
                ahead += _AWAY if end > step == steps else 0.0
            w_s, v_s, now = w_s + dt * v_after, v_after, 1 - now
            step += 1
        kink.straighten(w, grid, contact.kink)
        return 1 - now

    return march
