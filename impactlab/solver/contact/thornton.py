"""Thornton's elastic-perfectly plastic contact: the contact pressure is cut at p_y.

Sources: Thornton 1997 (J. Applied Mechanics 64, 383); Thornton and Ning 1998. p_y = 1.6 S_y:
    delta_y = (R/4) (pi p_y/E)^2, F_y = (1/6) (R/E)^2 (pi p_y)^3
    delta <= delta_y  Hertz
    beyond            F = F_y + pi p_y R (delta - delta_y)
    unloading         F = (4/3) E sqrt(R_p) (delta - delta_r)^1.5, force continuous,
                      R_p = (4 E/(3 F_m)) ((2 F_m + F_y)/(2 pi p_y))^1.5
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

LIMITING_PRESSURE = 1.6
"""p_y/S_y."""


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of Thornton's law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    pressure = math.pi * LIMITING_PRESSURE * S_y
    delta_y = 0.25 * R * (pressure / E) ** 2
    if delta <= delta_y:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    F_y = K * delta_y * math.sqrt(delta_y)
    F = F_y + pressure * R * (delta - delta_y)
    R_p = 4.0 * E / (3.0 * F) * (0.5 * (2.0 * F + F_y) / pressure) ** 1.5
    K_p = 4.0 / 3.0 * E * math.sqrt(R_p)
    return F, K_p, delta - (F / K_p) ** (2.0 / 3.0), 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which a = sqrt(R delta) reaches R."""
    return R


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle, a = sqrt(R delta), beyond yield, too."""
    return math.sqrt(R * delta)
