"""Stronge's elastic-plastic contact, unloading with force continuity after Wang et al.

Sources: Stronge, Impact Mechanics (2000), chapter 6; the paper, its Table 1 and Eqs. 15 to 17
(misprints corrected: docs/theory.md). th = 1.1; x = delta/delta_y, u = 2 x - 1:
    x <= 1                       F = F_y x^1.5
    elastic-plastic              F = F_y u (1 + ln(u)/(3 th))
    fully plastic, u > U_PLASTIC F = 2.8 F_y u/th, joined where the two agree (x = 82.511)
    unloading                    F = (4/3) E sqrt(R_e) (delta - delta_r)^1.5,
                                 R_e = R sqrt(F_m/F_y), delta_r = delta_m - delta_y R_e/R
The law is followed as it stands, with two flaws of its own: the unloading curve gives back more
than loading took for 1 < x < 2.673 (restitution up to 1.10; the dissipation is negative there),
and it ends below zero indentation for 1 < x < 1.998 (delta_r < 0).
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

THETA = 1.1
MEAN_PRESSURE = 2.8
"""Fully plastic mean pressure over the yield stress."""
U_PLASTIC = math.exp(3.0 * (MEAN_PRESSURE - THETA))


@compiled
def yield_indentation(E: float, R: float, S_y: float) -> float:
    """Return delta_y in m."""
    return (0.75 * math.pi * THETA * S_y / E) ** 2 * R


@compiled
def force_ratio(u: float) -> float:
    """Return F/F_y beyond yield."""
    return u * (1.0 + math.log(u) / (3.0 * THETA)) if u <= U_PLASTIC else MEAN_PRESSURE * u / THETA


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of Stronge's law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_y = yield_indentation(E, R, S_y)
    if delta <= delta_y:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    ratio = force_ratio(2.0 * delta / delta_y - 1.0)
    F = ratio * K * delta_y * math.sqrt(delta_y)
    radius_ratio = math.sqrt(ratio)
    return F, K * math.sqrt(radius_ratio), delta - delta_y * radius_ratio, 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which a = sqrt(R (2 delta - delta_y)) reaches R."""
    return 0.5 * (R + yield_indentation(E, R, S_y))


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle, beyond yield a = sqrt(R (2 delta - delta_y))."""
    return math.sqrt(R * max(delta, 2.0 * delta - yield_indentation(E, R, S_y)))
