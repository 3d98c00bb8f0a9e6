"""Kogut and Etsion's contact, fitted to finite elements; unloading: Etsion, Kligerman and Kadin.

Sources: Kogut and Etsion 2002 (J. Applied Mechanics 69, 657), constants as in public code;
Etsion, Kligerman and Kadin 2005 (Int. J. Solids and Structures 42, 3716), constants remembered.
H = 2.8 S_y, K = 0.454 + 0.41 nu, delta_c = (pi K H/(2 E))^2 R, y = delta/delta_c:
    y <= 1     Hertz
    1 to 6     F/F_c = 1.03 y^1.425
    6 to 110   F/F_c = 1.40 y^1.263
    beyond     F = 2 pi R H delta
    unloading  F = F_m ((delta - delta_r)/(delta_m - delta_r))^n, n = 1.5 y_m^(-0.0331),
               delta_r = delta_m (1 - y_m^(-0.28)) (1 - y_m^(-0.69))
The three forces do not meet: each limit is a jump upwards.
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

HARDNESS = 2.8
"""H/S_y."""
ELASTIC_PLASTIC = 6.0
FULLY_PLASTIC = 110.0
"""y at which the fits end."""


@compiled
def _critical_indentation(E: float, R: float, S_y: float, nu: float) -> float:
    return (0.5 * math.pi * (0.454 + 0.41 * nu) * HARDNESS * S_y / E) ** 2 * R


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of the law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_c = _critical_indentation(E, R, S_y, nu)
    y = delta / delta_c
    if y <= 1.0:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    if y <= FULLY_PLASTIC:
        ratio = 1.03 * y**1.425 if y <= ELASTIC_PLASTIC else 1.40 * y**1.263
        F = K * delta_c * math.sqrt(delta_c) * ratio
    else:
        F = 2.0 * math.pi * R * HARDNESS * S_y * delta
    delta_r = delta * (1.0 - y**-0.28) * (1.0 - y**-0.69)
    n = 1.5 * y**-0.0331
    return F, F / (delta - delta_r) ** n, delta_r, n


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which the fits end."""
    return FULLY_PLASTIC * _critical_indentation(E, R, S_y, nu)


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle, from its area over that of first yield.

    0.93 y^1.136 up to y = 6, 0.94 y^1.146 up to 110 (remembered), but no less than Hertz's, y;
    beyond that the truncated sphere's, 2 y.
    """
    y = delta / _critical_indentation(E, R, S_y, nu)
    area = y
    if y > FULLY_PLASTIC:
        area = 2.0 * y
    elif y > 1.0:
        area = max(y, 0.93 * y**1.136 if y <= ELASTIC_PLASTIC else 0.94 * y**1.146)
    return math.sqrt(R * delta * area / y)
