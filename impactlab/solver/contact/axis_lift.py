"""The lift of a strip's axis by the contact above it.

Indentations are reckoned from the beam's axis, the depth z below the surface
(model/contact_compliance.py). There a contact of the radius a differs from a point force on an
elastic half-space in two ways, both of which leave the axis higher:

    lift = delta_r (a/z)^2 (A - B a/z) + F (1 + nu)(5 - 2 nu) a^2/(8 pi E z^3)

The first is what the plastic strains do. It stays when the contact unloads, so that a dent, seen
from the axis, is that much deeper. A and B, quadratic in the logarithm of x = delta_m/delta_y, are
fitted to axis_lift.csv (tests/benchmarks/sphere_indentation.py --depth 320 --elements 60 --axis),
the displacement of the axis above that of the elastic half-space under the same pressure, for
E*/S_y = 333 and nu = 0.3: within 0.08 % of delta_m from x = 5 on up to a/z = 0.4. Beyond that the
plastic zone reaches the axis, and a/z counts as 0.45 at most. The second is an even pressure, to
second order in a/z.

Neglected: other beams than strips, the beam's lower face, and what the plastic strains do to the
bending of the beam.
"""

import math

from impactlab.solver.contact.history import Pair, yield_stress
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.contact.switch import radius
from impactlab.solver.contact_patch import contact_radius
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

LARGEST_X, LARGEST_SHARE = 320.0, 0.45
"""x and a/z beyond which the fit is held."""


@compiled
def plastic_lift(x: float, share: float) -> float:
    """Return the lift by plastic strains over delta_r; share = a/z."""
    log = math.log(min(max(x, 1.0), LARGEST_X))
    share = min(share, LARGEST_SHARE)
    A = 0.5762 - log * (0.0097 + 0.0104 * log)
    B = 0.3802 + log * (0.3015 - 0.0537 * log)
    return share * share * (A - B * share)


@compiled
def axis_lift(
    contact: Record, pair: Pair, F: float, z: float, pressure: float, hardness: float
) -> float:
    """Return the lift (m) under the contact force F (N) of an axis at the depth z (m).

    pressure: (1 + nu)(5 - 2 nu)/(8 pi E z^3), in 1/(N m). hardness: the sphere's yield stress (Pa);
    one that is no harder than the beam yields in its place.
    """
    if contact.F_m <= 0.0:
        return 0.0
    a = contact_radius(contact, pair, F)
    lift = pressure * F * a * a
    S_y = yield_stress(contact, pair)
    if contact.delta_r > 0.0 and S_y < hardness:
        x = contact.delta_m / yield_indentation(pair.E, pair.R, S_y)
        a = radius(pair.law, contact.delta_m, pair.E, pair.R, S_y, pair.nu)
        lift += contact.delta_r * plastic_lift(x, a / z)
    return float(lift)
