"""Stronge's elastic-plastic contact, its loading capped by Hertz's so that it creates no energy.

Source: stronge.py, whose loading lies above Hertz's force for 1 < x < 15.416. Here, with
x = delta/delta_y and F_S/F_y = u (1 + ln(u)/(3 th)) or 2.8 u/th, as there:
    loading    F = F_y min(x^1.5, F_S/F_y)
    unloading  that of stronge.py from this force: R_e = R sqrt(F_m/F_y)
Up to x = 15.416 the unloading gives back x^(-1/4) of the loading work, and leaves x - x^(3/4) >= 0.
The cap is our own choice; a cap by the elastic force follows from yielding being a loss.
"""

import math

from impactlab.solver.contact.stronge import force_ratio, yield_indentation
from impactlab.solver.contact.stronge import limit as limit
from impactlab.solver.contact.stronge import radius as radius
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of the capped law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_y = yield_indentation(E, R, S_y)
    if delta <= delta_y:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    x = delta / delta_y
    ratio = min(x * math.sqrt(x), force_ratio(2.0 * x - 1.0))
    radius_ratio = math.sqrt(ratio)
    F = ratio * K * delta_y * math.sqrt(delta_y)
    return F, K * math.sqrt(radius_ratio), delta - delta_y * radius_ratio, 1.5
