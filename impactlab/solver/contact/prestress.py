"""A contact on metal that the beam's bending has put under stress: `contact_prestress: bending`.

Under compression along its surface metal yields at a larger contact force, under tension at a
smaller one. With s_x, s_y, the stresses along and across the beam over the yield stress at half the
contact radius below the surface, and x = delta_m/delta_y, yielding goes on at the force g F_m:

    g = (1 + k e/3)^3, k = 3/x + (1 - 1/x)(K_0 - K_1 x),
    e = -(s_x + s_y)/2 - B (s_x + s_y)^2 - C (s_x - s_y)^2.

Below it the contact is elastic, on the law's own unloading curve for delta_m, which is its only
state: a changing stress does no work, and what is dissipated is what the free energy loses when
delta_m grows. At first yield g is, to first order, von Mises' in the field of Hertz; by symmetry
each of two stresses has half the effect of both. Where the sphere yields as well, g - 1 is less by
its share in that (metals.py): it is under no such stress.

K_0, K_1, B: fitted to prestress.csv, the half-space of tests/benchmarks/sphere_indentation.py under
-0.6, -0.3 and 0.3 yield stresses in all directions along its surface (--depth 300 --elements 40).
The force at equal indentation changes by up to 13, 7 and -8 %, least where deep; the fit is within
1.6 of that in the mean from x = 10 to 40, to 120, to 200 and to 300. C: fitted to 3-D finite
elements of an impact (5 m/s, H 40 mm, R 20 mm) with -0.6, -0.3 and 0.3 along the beam, which change
it by 5.1, 3.1 and -4.2 % from x = 40 on (the fit: 4.7, 3.1, -4.5). With a stress that falls to zero
at four contact radii below the surface the solve gives what it gives with the even one of half a
radius.

Between the sides of a narrow beam the contact's plastic zone takes the whole width, and shares its
metal with bending: with the share sigma of the force that the sides take off (history.sideways) and
the compression s of the struck face by bending over the yield stress, F becomes F/(1 + q s sigma)
(q: SHARED). The section in turn gives way to the contact's flow (kink.py). Both numbers were fitted
to 3-D finite elements of narrow beams (tests/benchmarks/large_contacts.py).

s_x is that of the moment, s_y that of bending across the width (solver/strip.py); both fall with
depth, and have a part in the force itself, the half-space's stresses taken out
(model/contact_compliance.py). Together they are at most at yield.
"""

import math

from impactlab.solver.contact.history import (
    MISSED,
    Pair,
    bracketed,
    load,
    pair_radius,
    recovered,
    sideways,
    softer_share,
    yield_stress,
)
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

K_0, K_1, B, C = 0.39, 0.0008, 0.085, 0.23
SHARED = 0.12
LARGEST = 320.0
"""x at which the data end."""
_ITERATIONS, _ROUNDING, _TOUCH, _LEAST = 60, 1e-14, 1e-6, 0.1


@compiled
def strengthening(x: float, along: float, across: float) -> float:
    """Return g for stresses over the yield stress; any does below first yield."""
    x = min(max(x, 1.0), LARGEST)
    mises = math.sqrt(along * along - along * across + across * across)
    share = 1.0 / max(mises, 1.0)
    total, difference = share * (along + across), share * (along - across)
    k = 3.0 / x + (1.0 - 1.0 / x) * (K_0 - K_1 * x)
    e = -0.5 * total - B * total * total - C * difference * difference
    return max(1.0 + k * e / 3.0, _LEAST) ** 3


@compiled
def _yields(contact: Record, pair: Pair) -> tuple[float, float]:
    """Return the force (N) and the approach (m) at which the contact yields on."""
    depth, along, across = pair.prestress
    S_y = yield_stress(contact, pair)
    a = pair_radius(pair, contact.delta_m, S_y)
    left = max(1.0 - a / depth, 0.0)
    s_x = (along * contact.F_m - left * contact.stress_along) / S_y
    s_y = (across * contact.F_m - left * contact.stress_across) / S_y
    x = contact.delta_m / yield_indentation(pair.E, pair.R, S_y)
    g = 1.0 + softer_share(contact, pair, S_y) * (strengthening(x, s_x, s_y) - 1.0)
    F = g * contact.F_m
    if max(pair.crowding) > 0.0:
        bent = max(contact.stress_along / S_y, 0.0)
        F /= 1.0 + SHARED * bent * sideways(contact, pair)
    recovers = (F / contact.K) ** (1.0 / contact.n)
    return F, contact.delta_r + recovers + pair.compliance * F


@compiled
def complementary(F: float, K: float, delta_r: float, n: float) -> float:
    """Return F delta less the energy stored on an unloading curve, in J."""
    return float(F * (delta_r + (F / K) ** (1.0 / n) * n / (n + 1.0)))


_load_between = bracketed(_yields)


@compiled
def load_to(contact: Record, pair: Pair, approach: float) -> float:
    """Let the contact yield until it bears `approach`; return the force (N).

    By secants; where those fail, by brackets. NaN where there is none: the spring gives way faster
    than the law stiffens.
    """
    start, bears = _yields(contact, pair)
    lowest = before = contact.delta_m
    missed_before = bears - approach
    K, delta_r, n = contact.K, contact.delta_r, contact.n
    delta, F, step, missed = before - missed_before, start, 1.0, 1.0
    for _ in range(_ITERATIONS):
        load(contact, pair, delta)
        F, bears = _yields(contact, pair)
        missed = bears - approach
        if delta == before or missed == missed_before:
            break
        step = missed * (delta - before) / (missed - missed_before) if missed != 0.0 else 0.0
        if abs(step) <= _ROUNDING * approach:
            break
        before, missed_before = delta, missed
        delta = max(delta - step, lowest)
    if not (abs(step) <= _ROUNDING * approach and abs(missed) <= MISSED * approach):
        F = _load_between(contact, pair, lowest, approach)
    mean = 0.5 * (start + F)
    contact.work += complementary(mean, contact.K, contact.delta_r, contact.n)
    contact.work -= complementary(mean, K, delta_r, n)
    return F


@compiled
def force(contact: Record, pair: Pair, approach: float) -> float:
    """Return the contact force (N) at `approach` (m); yield where it bears no more."""
    furthest = max(contact.approach_m, approach)
    if contact.delta_m == 0.0:
        if approach <= 0.0:
            return 0.0
        load(contact, pair, _TOUCH * approach)
    if approach > _yields(contact, pair)[1]:
        F = load_to(contact, pair, approach)
    else:
        F = contact.K * recovered(contact, pair, approach) ** contact.n
    contact.approach_m, contact.peak_force = furthest, max(contact.peak_force, F)
    return F
