"""Brake's unloading, on the loading of the modified Jackson-Green law.

Source: Brake 2015 (Int. J. Solids and Structures 62, 104), as in public code, which joins it to
the loading of mjg.py (see the registry). With F_H the force of Hertz at delta_m:
    delta_r = delta_m (1 - F_m/F_H)
    F = F_m ((delta - delta_r)/(delta_m - delta_r))^1.5
The softer the contact beside Hertz's, the deeper the dent.
"""

import math

from impactlab.solver.contact.jackson_green import ONSET, critical_indentation, indentation_at
from impactlab.solver.contact.jackson_green import radius as radius
from impactlab.solver.contact.mjg import loading
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_c = critical_indentation(E, R, S_y, nu)
    F = loading(delta, delta_c, E, R, S_y, nu)
    if delta <= ONSET * delta_c:
        return F, K, 0.0, 1.5
    recovered = delta * F / (K * delta * math.sqrt(delta))
    return F, F / recovered**1.5, delta - recovered, 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return where (m) a/R reaches 1, the limit of the loading; unloading has none."""
    return indentation_at(1.0, E, R, S_y, nu)
