"""The damping of contact laws that have one, the function `damping` of the law's file.

A law gives the force that it adds to that of its curves at the approach d and its rate d'. At step
n the rate is extrapolated, with second order, from the approaches so far,

    d'_n = (3 d_n - 4 d_(n-1) + d_(n-2))/(2 dt),

so the step stays explicit, and no model of the beam has to know of it. (The central rate is
unknown until the beam has moved. Where a contact begins d_(n-2) may lie further back, while the
force is nearly zero.) The damper is parallel to the law and its compliance: approach is that of
the bodies. Contacts do not pull: a whole force below zero is made zero. What the damper takes is
dissipated: the trapezoidal sum of its force over the approach.

The extrapolated rate of the fastest motion, which changes sign with each step, is 4 d_n/dt, so a
damper c (N s/m) counts as a stiffness 4 c/dt there: stability.py makes the time step smaller by it.
"""

from impactlab.solver.contact.history import Pair
from impactlab.solver.contact.switch import damping
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record


@compiled
def damped_force(
    contact: Record, pair: Pair, F: float, approach: float, before: float, earlier: float, dt: float
) -> float:
    """Return the contact force (N) with damping, and add up what that takes.

    F: the force (N) of the law's curves; before, earlier: the approach (m) of the last two steps.
    """
    total = F
    if F != 0.0:
        rate = (3.0 * approach - 4.0 * before + earlier) / (2.0 * dt)
        total += damping(pair.law, F, approach, rate, pair.E, pair.R, pair.S_y, pair.nu)
        total = 0.0 if total < 0.0 else total  # NaN stays
    mean = 0.5 * (contact.damping + total - F)
    contact.damping_work += mean * (approach - before)
    contact.damping = total - F
    return total
