"""Hertz contact: F = (4/3) E* sqrt(R*) delta^1.5, elastic, the same way back.

Source: Hertz 1881; Johnson, Contact Mechanics, eq. 4.23.

Every law is three functions of this form. In: indentation delta (m), effective modulus E (Pa),
effective radius R (m), the softer body's yield stress S_y (Pa) and Poisson's ratio nu.
`curve` gives (F, K, delta_r, n), the loading force (N) at delta, and the curve on which the contact
unloads from there, K (d - delta_r)^n. `limit` gives the indentation (m) up to which the law holds;
why, and what of the law is not confirmed, is in the registry (__init__.py). `radius` gives the
radius (m) of the contact circle while the contact is loaded.

A viscous law has a fourth function, `damping` (see hunt_crossley.py): the force (N) to add to F,
the force on its curve, where the approach is delta (m) and grows at `rate` (m/s).
"""

import math

from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of Hertz contact."""
    K = 4.0 / 3.0 * E * math.sqrt(R)
    return K * delta * math.sqrt(delta), K, 0.0, 1.5


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which a = sqrt(R delta) reaches R."""
    return R


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle of Hertz, a = sqrt(R delta)."""
    return math.sqrt(R * delta)
