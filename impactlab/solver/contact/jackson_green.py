"""Jackson and Green's elastic-plastic contact, fitted to finite elements, without hardening.

Sources: Jackson and Green 2005 (J. Tribology 127, 343) for loading; Jackson, Chusoipin and Green
2005 (J. Tribology 127, 484) for unloading; constants as in public code (see the registry).
    C = 1.295 exp(0.736 nu), delta_c = (pi C S_y/(2 E))^2 R, y = delta/delta_c
    y <= 1.9   Hertz
    beyond     F/F_c = exp(-y^(5/12)/4) y^1.5 + (4 H/(C S_y)) (1 - exp(-y^(5/9)/25)) y,
               H/S_y = 2.84 (1 - exp(-0.82 (a/R)^(-0.7)))
               a = sqrt(R delta) (y/1.9)^(B/2), B = 0.14 exp(23 S_y/E)
    unloading  from y_m > 1: F = F_m ((delta - delta_r)/(delta_m - delta_r))^1.5,
               delta_r = 1.02 delta_m (1 - ((y_m + 5.9)/6.9)^(-0.54))
The fit of delta_r passes delta_m at y_m = 10012. It is held at 0.99 delta_m, and the law's range
ends there (y_m = 4725), if it has not before.
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

ONSET = 1.9
"""y at which the force leaves Hertz's."""
LARGEST_RADIUS = 0.41
"""a/R up to which the fit was made."""
LARGEST_RESIDUAL = 0.99
"""delta_r/delta_m at most."""
LARGEST_INDENTATION = 6.9 * (1.0 - LARGEST_RESIDUAL / 1.02) ** (-1.0 / 0.54) - 5.9
"""y at which delta_r/delta_m reaches it."""


@compiled
def critical_indentation(E: float, R: float, S_y: float, nu: float) -> float:
    """Return delta_c in m, at which the first point yields."""
    return (0.5 * math.pi * _strength(nu) * S_y / E) ** 2 * R


@compiled
def _strength(nu: float) -> float:
    """Return C, the largest Hertz pressure at first yield over S_y."""
    return 1.295 * math.exp(0.736 * nu)


@compiled
def _widening(E: float, S_y: float) -> float:
    """Return B, the exponent by which the contact circle grows beyond Hertz's."""
    return 0.14 * math.exp(23.0 * S_y / E)


@compiled
def contact_radius(delta: float, delta_c: float, E: float, R: float, S_y: float) -> float:
    """Return a/R beyond the onset."""
    y = delta / (ONSET * delta_c)
    return math.sqrt(delta / R) * y ** (0.5 * _widening(E, S_y))


@compiled
def indentation_at(radius: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which a/R reaches `radius`."""
    B, onset = _widening(E, S_y), ONSET * critical_indentation(E, R, S_y, nu)
    return (radius * radius * R * onset**B) ** (1.0 / (1.0 + B))


@compiled
def force_ratio(y: float, hardness: float, nu: float) -> float:
    """Return F/F_c beyond the onset; hardness: H/S_y."""
    elastic = math.exp(-0.25 * y ** (5.0 / 12.0)) * y * math.sqrt(y)
    plastic = 4.0 * hardness / _strength(nu) * (1.0 - math.exp(-(y ** (5.0 / 9.0)) / 25.0)) * y
    return elastic + plastic


@compiled
def residual(y: float) -> float:
    """Return delta_r/delta_m after y_m = y."""
    return min(1.02 * (1.0 - ((y + 5.9) / 6.9) ** (-0.54)), LARGEST_RESIDUAL) if y > 1.0 else 0.0


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of Jackson and Green (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_c = critical_indentation(E, R, S_y, nu)
    y = delta / delta_c
    F = K * delta * math.sqrt(delta)
    if y <= 1.0:
        return F, K, 0.0, 1.5
    if y > ONSET:
        a = contact_radius(delta, delta_c, E, R, S_y)
        hardness = 2.84 * (1.0 - math.exp(-0.82 * a**-0.7))
        F = K * delta_c * math.sqrt(delta_c) * force_ratio(y, hardness, nu)
    delta_r = residual(y) * delta
    return F, F / (delta - delta_r) ** 1.5, delta_r, 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return where (m) a/R reaches 0.41, or the fit of the residual indentation ends."""
    end = LARGEST_INDENTATION * critical_indentation(E, R, S_y, nu)
    return min(indentation_at(LARGEST_RADIUS, E, R, S_y, nu), end)


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle, beyond the onset that of contact_radius."""
    delta_c = critical_indentation(E, R, S_y, nu)
    wider = contact_radius(delta, delta_c, E, R, S_y) if delta > ONSET * delta_c else 0.0
    return max(math.sqrt(R * delta), R * wider)
