"""Stronge's elastic-plastic contact with Stronge's own unloading, which begins with a jump.

Source: Stronge, Impact Mechanics (2000), chapter 6. Loading: stronge.py. Unloading from delta_m,
x = delta_m/delta_y:
    F = (4/3) E sqrt(R_e) (delta - delta_r)^1.5,
    R_e = R sqrt(2 x - 1), delta_r = delta_m - delta_y R_e/R
so that it begins at F_y (2 x - 1): below the loading force, by its factor 1 + ln(2 x - 1)/(3 th).
The force jumps while nothing moves, which takes no work; what is dissipated is what loading took
less what the unloading curve gives back, as in every law.
"""

import math

from impactlab.solver.contact.stronge import force_ratio, yield_indentation
from impactlab.solver.contact.stronge import limit as limit
from impactlab.solver.contact.stronge import radius as radius
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of Stronge's law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_y = yield_indentation(E, R, S_y)
    if delta <= delta_y:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    u = 2.0 * delta / delta_y - 1.0
    F = force_ratio(u) * K * delta_y * math.sqrt(delta_y)
    radius_ratio = math.sqrt(u)
    return F, K * math.sqrt(radius_ratio), delta - delta_y * radius_ratio, 1.5
