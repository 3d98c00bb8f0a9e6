"""Yield stress by the strain rate, after Cowper and Symonds.

A fibre that flows at the rate p' has the yield stress

    Y (1 + (p'/D)^(1/q)), Y = S_y + H_i p, p the equivalent plastic strain (PEEQ),

with D in 1/s; D = 0 stands for no dependence on the rate. In reverse it is Perzyna's law of
viscoplasticity, p' = D (overstress/Y)^q, which is solved implicitly in the time step (backward
Euler), and is stable at any. The overstress does work, which is summed up by the trapezoidal rule
and counts as dissipated.

In the contact the yield stress of the beam is that at one rate for the whole impact, Tabor's
representative strain 0.2 a/R at the largest indentation over the time until then, both of Hertz's
impact on a half-space: 0.2 v/(1.4716 sqrt(R delta_m)), 80/s in the paper's case. A contact law, its
unloading and its energy are made for one yield stress. Half or twice the rate changes what is added
to the yield stress by 15 % if q = 5.

Sources: Cowper, Symonds, Brown University, Applied Mathematics Report 28 (1957); Perzyna, Advances
in Applied Mechanics 9 (1966) 243; Tabor, The Hardness of Metals (1951). All as remembered.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

_NEWTON_STEPS = 60
_ROUND_OFF = 1e-13


class CowperSymonds(NamedTuple):
    """D (1/s; 0: no dependence on the rate) and q."""

    D: float
    q: float


@compiled
def rate_factor(rate: float, D: float, q: float) -> float:
    """Return the yield stress at a strain rate (1/s), over the static one."""
    return 1.0 + (rate / D) ** (1.0 / q) if D > 0.0 else 1.0


@compiled
def contact_rate(case: Record, E: float, R: float) -> float:
    """Return the representative strain rate under the contact, in 1/s; E, R: see Pair."""
    energy = case.sphere_mass * case.velocity**2
    delta_m = (15.0 * energy / (16.0 * E * math.sqrt(R))) ** 0.4
    return float(0.2 * case.velocity / (1.4716 * math.sqrt(R * delta_m)))


@compiled
def overstress_ratio(
    trial: float, Y: float, H_i: float, stiffness: float, D_dt: float, q: float
) -> float:
    """Return s = overstress/Y at the step's end, the root of trial = Y (1 + s) + flow(s).

    trial: the stress (Pa) relative to the back stress if nothing flowed, above Y. Flow: a PEEQ of
    D dt s^q takes (stiffness + H_i (1 + s)) times it off the trial stress. Concave and falling, so
    that Newton's method comes down to the root from above.
    """
    s = min(trial / Y - 1.0, ((trial - Y) / ((stiffness + H_i) * D_dt)) ** (1.0 / q))
    for _ in range(_NEWTON_STEPS):
        slip = D_dt * s**q
        modulus = stiffness + H_i * (1.0 + s)
        slope = Y + H_i * slip + modulus * q * slip / s
        step = (trial - Y * (1.0 + s) - modulus * slip) / slope
        s += step
        if abs(step) <= _ROUND_OFF * s:
            break
    return s
