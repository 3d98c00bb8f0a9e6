"""The modified Jackson-Green contact: its hardness falls with the contact circle for good.

Sources: Ghaednia, Brake, Berryhill and Jackson 2019 (J. Tribology 141), eqs. 5, 6, 23, 24 and 27 to
29 without hardening, for loading; Jackson, Chusoipin and Green 2005 for unloading; constants as in
public code (see the registry). As jackson_green.py, but for
    H/S_y = 2.84 - 0.92 (1 - cos(pi a/R))
The earlier form (Ghaednia, Marghitu and Jackson 2015: 0.17 for 1/4, 1/78 for 1/25), as remembered,
drops by 10.7 % at y = 1.9; it could not be confirmed and is not used.
"""

import math

from impactlab.solver.contact.jackson_green import (
    LARGEST_INDENTATION,
    ONSET,
    contact_radius,
    critical_indentation,
    force_ratio,
    indentation_at,
    residual,
)
from impactlab.solver.contact.jackson_green import radius as radius
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def loading(delta: float, delta_c: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the force in N."""
    K, y = 4.0 / 3.0 * E * math.sqrt(R), delta / delta_c
    if y <= ONSET:
        return K * delta * math.sqrt(delta)
    a = contact_radius(delta, delta_c, E, R, S_y)
    hardness = 2.84 - 0.92 * (1.0 - math.cos(math.pi * a))
    return K * delta_c * math.sqrt(delta_c) * force_ratio(y, hardness, nu)


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of the modified law (see contact/hertz.py for the form)."""
    delta_c = critical_indentation(E, R, S_y, nu)
    F = loading(delta, delta_c, E, R, S_y, nu)
    if delta <= delta_c:
        return F, 4.0 / 3.0 * E * math.sqrt(R), 0.0, 1.5
    delta_r = residual(delta / delta_c) * delta
    return F, F / (delta - delta_r) ** 1.5, delta_r, 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return where (m) the hardness would rise again (a/R = 1), or the fit of the residual ends."""
    end = LARGEST_INDENTATION * critical_indentation(E, R, S_y, nu)
    return min(indentation_at(1.0, E, R, S_y, nu), end)
