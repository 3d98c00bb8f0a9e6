"""The contact's memory: how far it was loaded, and the curve on which it unloads and reloads.

Loading follows the law; below the largest indentation so far, delta_m, the force is
K (delta - delta_r)^n in both directions (reloading retraces unloading, then loading goes on).

The approach is what the bodies' motion gives, delta the law's indentation. They differ where the
bodies are no half-spaces (model/contact_compliance.py): approach = delta + compliance F. That
spring stores compliance F^2/2, below zero where it takes back what law and beam both count.

Some laws' forces jump up at a delta. Under a positive compliance delta then stands still while
the approach grows, until the spring bears the whole jump: the contact is in a mixture of its states
below and above. Under a negative one the approach that the contact bears falls at the jump: delta
snaps, at one approach, to where it is borne again, along the spring's line, which lies below the
law's force: loading takes the less work.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from impactlab.solver.contact import LAWS, finite_element, metals
from impactlab.solver.contact.metals import LIKE_METALS, shape
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.contact.switch import curve, radius
from impactlab.solver.jit import compiled, inlined
from impactlab.solver.strain_rate import RateLaw, rate_law
from impactlab.solver.types import HALF_SPACE, Crowding, Record, Shape, Unloading, record

_OF_METALS = LAWS.index("finite_element")
"""The law whose curve depends on more of the metals than the others'."""


class Pair(NamedTuple):
    """Two bodies in contact.

    law: its number; E, R: effective modulus (Pa) and radius (m); S_y, nu: the softer body's yield
    stress (Pa) and Poisson's ratio. compliance (m/N), bending (m2): approach of the bodies beyond
    that of half-spaces, per force and per M/(EI) at mid-span; zero for half-spaces.
    prestress: depth of the beam (m; 0: its stress is ignored) and stresses along and across it per
    force (1/m2), see contact/prestress.py. shape, crowding (1/m2): of the law's curve by the two
    metals, and by the sides of the beam (contact/finite_element.py). rate: the law by which S_y
    grows with the strain rate, up to `hardest` (Pa), at which the other body would yield
    (contact/rate.py).
    """

    law: int
    E: float
    R: float
    S_y: float
    nu: float
    compliance: float = 0.0
    bending: float = 0.0
    prestress: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shape: Shape = LIKE_METALS
    crowding: Crowding = HALF_SPACE
    rate: RateLaw = RateLaw()
    hardest: float = np.inf


CONTACT = record(
    """
    delta_m F_m K delta_r n work delta_w approach_m largest shift shift_before bending_work
    stress_along stress_across peak_force damping damping_work stress
    dent_area kink kink_work sunk sunk_before punching_work
    """
)
"""delta_m (m), F_m (N): furthest point on the loading curve. K (N/m^n), delta_r (m), n: the
unloading curve from there. work (J): integral of the loading force from 0 to delta_w (m).
approach_m (m): the approach at delta_m. Where bending counts, shift (m): what it adds to the
approach, now and a step before; bending_work (J): of the force on it; largest (m): approach and
shift. With prestress: stress_along, stress_across (Pa), by bending, of the beam's lower face;
approach_m is the largest of all. With prestress, or a law of the strain rate, work is what is
dissipated. peak_force (N): with either, or a damped law, whose damping (N) at the last step has
taken damping_work (J). stress (Pa): the representative one, see contact/rate.py. dent_area
(m2), kink (rad), kink_work (J): see solver/kink.py; sunk, now and a step before (m), punching_work
(J): see solver/punching.py."""

PANELS = 8
_ITERATIONS, _MARCHES, _ROUNDING = 60, 1000, 1e-14
MISSED = 1e-10
"""Of the approach: secants that end farther off have ended at a jump."""
# Gauss-Legendre on [0, 1], 4 points
_GAUSS = (
    (0.06943184420297371, 0.17392742256872693),
    (0.33000947820757187, 0.32607257743127307),
    (0.6699905217924281, 0.32607257743127307),
    (0.9305681557970263, 0.17392742256872693),
)


@compiled
def make_pair(case: Record) -> Pair:
    """Return sphere against flat beam: 1/E* = (1 - nu_s^2)/E_s + (1 - nu_b^2)/E_b, R* = R_s."""
    of_beam = (1.0 - case.beam_poissons_ratio**2) / case.beam_youngs_modulus
    compliance = (1.0 - case.sphere_poissons_ratio**2) / case.sphere_youngs_modulus + of_beam
    E, R = 1.0 / compliance, case.sphere_radius
    S_y, nu, rate = case.beam_yield_stress, case.beam_poissons_ratio, rate_law(case)
    share, hardness = E * of_beam, case.sphere_yield_stress / S_y
    kinematic = case.beam_kinematic_hardening_modulus
    hardening = case.beam_isotropic_hardening_modulus + kinematic
    kinematic = kinematic / hardening if hardening > 0.0 else 0.0
    hardening /= case.beam_youngs_modulus
    depth = case.beam_depth if case.contact_prestress > 0 else 0.0
    crowding = case.crowding, case.crowding_in_depth
    if S_y > case.sphere_yield_stress:
        S_y, nu, depth = case.sphere_yield_stress, case.sphere_poissons_ratio, 0.0
        share, hardness, hardening = 1.0 - share, 1.0 / hardness, 0.0
        crowding = 0.0, 0.0
        rate = RateLaw(0.0, 0.0, 0.0)
    compliances = case.compliance, case.bending_compliance
    prestress = depth, case.stress_along, case.stress_across
    curve_shape = shape(E / S_y, share, nu, hardening, kinematic, hardness)
    hardest = case.sphere_yield_stress
    return Pair(
        case.contact, E, R, S_y, nu, *compliances, prestress, curve_shape, crowding, rate, hardest
    )


@compiled
def yield_stress(contact: Record, pair: Pair) -> float:
    """Return the softer body's yield stress (Pa) at the contact's strain rate."""
    if pair.rate.D > 0.0:
        return min(max(pair.S_y, contact.stress), pair.hardest)
    return pair.S_y


@compiled
def pair_curve(pair: Pair, delta: float, S_y: float) -> Unloading:
    """Return force and unloading curve of these bodies' law (see contact/hertz.py).

    S_y: the yield stress (Pa) at the contact's strain rate.
    """
    if pair.law == _OF_METALS:
        return finite_element.curve(delta, pair.E, pair.R, S_y, pair.nu, pair.shape, pair.crowding)
    return curve(pair.law, delta, pair.E, pair.R, S_y, pair.nu)


@compiled
def pair_radius(pair: Pair, delta: float, S_y: float) -> float:
    """Return the radius (m) of the circle of contact by these bodies' law.

    S_y: the yield stress (Pa) at the contact's strain rate.
    """
    if pair.law == _OF_METALS:
        return float(finite_element.radius(delta, pair.E, pair.R, S_y, pair.nu, pair.shape))
    return float(radius(pair.law, delta, pair.E, pair.R, S_y, pair.nu))


@compiled
def sideways(contact: Record, pair: Pair) -> float:
    """Return the share of the contact's force that the faces of a beam take off."""
    if max(pair.crowding) == 0.0 or pair.law != _OF_METALS:
        return 0.0
    S_y = yield_stress(contact, pair)
    share = finite_element.sideways(contact.delta_m, pair.E, pair.R, S_y, pair.shape, pair.crowding)
    return float(share)


@compiled
def softer_share(contact: Record, pair: Pair, S_y: float) -> float:
    """Return the share of the softer body in what both yield; S_y: as of `pair_curve`."""
    if pair.law != _OF_METALS:
        return 1.0
    x = contact.delta_m / yield_indentation(pair.E, pair.R, S_y)
    return float(metals.softer_share(x, pair.shape))


@compiled
def load(contact: Record, pair: Pair, delta: float) -> None:
    """Move the furthest point of loading on to delta."""
    contact.delta_m = contact.approach_m = delta
    S_y = yield_stress(contact, pair)
    contact.F_m, contact.K, contact.delta_r, contact.n = pair_curve(pair, delta, S_y)


@compiled
def _stand(contact: Record, pair: Pair, low: float, high: float, share: float) -> None:
    """Let the contact stand at a jump of the force from `low` to `high`, with a share of it made.

    The unloading curve is that far between those of the jump's two ends.
    """
    load(contact, pair, high)
    F, delta_r, n = contact.F_m, contact.delta_r, contact.n
    start = contact.K * (high - delta_r) ** n
    load(contact, pair, low)
    start_below = contact.K * (low - contact.delta_r) ** contact.n
    contact.F_m += share * (F - contact.F_m)
    contact.delta_r += share * (delta_r - contact.delta_r)
    contact.n += share * (n - contact.n)
    start_below += share * (start - start_below)
    contact.K = start_below / (low - contact.delta_r) ** contact.n


def bracketed(bears: Callable[[Record, Pair], tuple[float, float]]) -> Any:
    """Return the search, by brackets, for where loading bears an approach.

    bears(contact, pair): force (N) and approach (m) at the furthest point of loading.
    """

    def load_between(contact: Record, pair: Pair, lowest: float, approach: float) -> float:
        """Load from `lowest` to the first indentation that bears `approach`; return the force (N).

        NaN where there is none up to the sphere's radius.
        """
        low = high = lowest
        F, missed, rounding = np.nan, 1.0, _ROUNDING * approach
        for _ in range(_MARCHES):  # steps that pass no solution where compliance < 0
            load(contact, pair, high)
            F, borne = bears(contact, pair)
            missed = approach - borne
            if missed <= rounding or not high < pair.R:
                break
            low, high = high, high + missed
        if abs(missed) <= rounding:
            return F
        if not missed < 0.0:
            load(contact, pair, np.nan)
            return np.nan
        middle = 0.5 * (low + high)
        while low < middle < high:
            load(contact, pair, middle)
            if bears(contact, pair)[1] < approach:
                low = middle
            else:
                high = middle
            middle = 0.5 * (low + high)
        share = width = 0.5
        for _ in range(_ITERATIONS):
            _stand(contact, pair, low, high, share)
            F, borne = bears(contact, pair)
            width *= 0.5
            share += width if borne < approach else -width
        return F

    return compiled(load_between)


@compiled
def _bears(contact: Record, pair: Pair) -> tuple[float, float]:
    return contact.F_m, contact.delta_m + pair.compliance * contact.F_m


_load_between = bracketed(_bears)


@compiled
def load_to(contact: Record, pair: Pair, approach: float) -> None:
    """Move the furthest point of loading on to where the approach is `approach`.

    By secants; where those fail, by brackets. NaN where there is none: the spring gives way faster
    than the law stiffens.
    """
    if pair.compliance == 0.0:
        load(contact, pair, approach)
        return
    lowest = before = contact.delta_m
    F_before = contact.F_m
    missed_before = before + pair.compliance * F_before - approach
    delta, step, missed = approach - pair.compliance * F_before, 1.0, 1.0
    S_y = yield_stress(contact, pair)
    for _ in range(_ITERATIONS):
        F, _, _, _ = pair_curve(pair, delta, S_y)
        missed = delta + pair.compliance * F - approach
        if delta == before or missed == missed_before:
            break
        step = missed * (delta - before) / (missed - missed_before) if missed != 0.0 else 0.0
        if abs(step) <= _ROUNDING * approach:
            break
        before, missed_before = delta, missed
        delta = max(delta - step, lowest)
    if abs(step) <= _ROUNDING * approach and abs(missed) <= MISSED * approach:
        load(contact, pair, delta)
    else:
        _load_between(contact, pair, lowest, approach)
    contact.approach_m = approach


@compiled
def recovered(contact: Record, pair: Pair, approach: float) -> float:
    """Return delta - delta_r (m) on the unloading curve, zero or more: Newton, from above."""
    over = approach - contact.delta_r
    if over <= 0.0:
        return 0.0
    gap, softness = over, pair.compliance * contact.K
    over = min(over, contact.delta_m - contact.delta_r) if softness < 0.0 else over
    for _ in range(_ITERATIONS):
        slope = softness * over ** (contact.n - 1.0)
        step = (over * (1.0 + slope) - gap) / (1.0 + contact.n * slope)
        over -= step
        if abs(step) <= _ROUNDING * gap:
            return over
    return np.nan


@inlined
def force(contact: Record, pair: Pair, approach: float) -> float:
    """Return the contact force (N) at `approach` (m); load further where it exceeds approach_m."""
    if approach > contact.approach_m:
        load_to(contact, pair, approach)
        return contact.F_m
    over = approach - contact.delta_r
    if over <= 0.0:
        return 0.0
    if pair.compliance != 0.0:
        over = recovered(contact, pair, approach)
    if contact.n == 1.5:
        return contact.K * over * math.sqrt(over)
    return contact.K * over**contact.n


@compiled
def loading_work(pair: Pair, start: float, stop: float, panels: int = PANELS) -> float:
    """Return the integral of the loading force over [start, stop], J.

    Gauss-Legendre with 4 points on each of so many panels of the square root of (delta - start),
    in which delta^1.5 is smooth at zero; the panels keep a regime limit of a law from costing
    accuracy. Where delta snaps, the force is that of the spring.
    """
    F, _, _, _ = pair_curve(pair, start, pair.S_y)
    total, furthest = 0.0, start + pair.compliance * F
    for panel in range(panels):
        for point, weight in _GAUSS:
            root = (panel + point) / panels
            delta = start + root * root * (stop - start)
            F, _, _, _ = pair_curve(pair, delta, pair.S_y)
            borne = delta + pair.compliance * F
            if borne < furthest:
                F = (furthest - delta) / pair.compliance
            else:
                furthest = borne
            total += weight * F * 2.0 * root
    return total * (stop - start) / panels


@compiled
def _released(contact: Record, over: float, fast: bool) -> float:
    """Return the energy (J) that unloading gives back from `over` (m) above its end."""
    if fast and contact.n == 1.5:
        return contact.K * 0.4 * over * over * math.sqrt(over)
    return contact.K * over ** (contact.n + 1.0) / (contact.n + 1.0)


@compiled
def energies(
    contact: Record, pair: Pair, approach: float, fast: bool = False
) -> tuple[float, float]:
    """Return (stored, dissipated) energy of the contact at `approach` (m), J.

    Dissipated is what loading took less what the unloading curve would give back; negative
    where a law creates energy. fast: with roots for powers.
    """
    summed = pair.prestress[0] > 0.0 or pair.rate.D > 0.0
    if contact.delta_m > contact.delta_w and not summed:
        contact.work += loading_work(pair, contact.delta_w, contact.delta_m)
        contact.delta_w = contact.delta_m
    released = 0.0 if summed else _released(contact, contact.delta_m - contact.delta_r, fast)
    over = max(approach - contact.delta_r, 0.0)
    if pair.compliance != 0.0:
        over = recovered(contact, pair, approach)
    stored = _released(contact, over, fast)
    if pair.compliance != 0.0:
        F = contact.K * over**contact.n
        stored += 0.5 * pair.compliance * F * F + contact.bending_work
    flowed = contact.damping_work + contact.punching_work - contact.kink_work
    return stored, contact.work - released + flowed
