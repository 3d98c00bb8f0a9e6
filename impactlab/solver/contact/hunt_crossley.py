"""Hunt and Crossley's viscous contact: Hertz's, with a damper that stiffens as the force grows.

Source: Hunt and Crossley 1975 (J. Applied Mechanics 42, 440). With the approach delta:
    F = k delta^n (1 + (3/2) alpha delta'), here with Hertz's k and n = 3/2.
The first integral of m delta'' = -F gives the coefficient of restitution e at the velocity v,
    (1 - s) exp(s) = (1 + r) exp(-r), r = (3/2) alpha v, s = e r,
which is e = 1 - alpha v for a small v (verification/solutions/hertz.py). The largest force
comes before the largest indentation. A sphere that leaves faster than 2/(3 alpha) would be pulled
back: contact_damping.py makes that force zero.
"""

from impactlab.solver.contact.hertz import curve as curve
from impactlab.solver.contact.hertz import limit as limit
from impactlab.solver.contact.hertz import radius as radius
from impactlab.solver.jit import compiled

ALPHA = 0.08
"""s/m: loss of restitution per velocity."""


@compiled
def damping(
    F: float, delta: float, rate: float, E: float, R: float, S_y: float, nu: float
) -> float:
    """Return the damping force (N), (3/2) alpha delta' F (see contact/hertz.py for the form)."""
    return 1.5 * ALPHA * rate * F
