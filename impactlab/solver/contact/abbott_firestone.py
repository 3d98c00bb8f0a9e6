"""Full plasticity after Abbott and Firestone: the hardness over the truncated sphere's section.

Source: Abbott and Firestone 1933 (Mechanical Engineering 55, 569), as Jackson and Green 2005
(J. Tribology 127, 343) state it for a sphere. H = 2.8 S_y, and beside Hertz's law, F = K delta^1.5:
    delta <= delta_p  Hertz, delta_p = (3 pi H/(2 E))^2 R, where the two forces agree
    beyond            F = 2 pi R H delta
    unloading         F = K (delta - delta_r)^1.5, force continuous: Hertz's curve, moved
Between first yield and full plasticity lies nothing, so the onset is far too late: the mean
pressure of Hertz's contact has reached 2 H there, because its circle is half the truncated one.
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

HARDNESS = 2.8
"""H/S_y."""


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Force and unloading curve of the law (see contact/hertz.py for the form)."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    if delta <= (1.5 * math.pi * HARDNESS * S_y / E) ** 2 * R:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    F = 2.0 * math.pi * R * HARDNESS * S_y * delta
    return F, K, delta - (F / K) ** (2.0 / 3.0), 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which the circle's radius, sqrt(2 R delta), reaches R."""
    return 0.5 * R


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle: Hertz's, or that of the truncated sphere.

    It grows by the factor sqrt(2) where the one becomes the other.
    """
    plastic = delta > (1.5 * math.pi * HARDNESS * S_y / E) ** 2 * R
    return math.sqrt(R * delta * (2.0 if plastic else 1.0))
