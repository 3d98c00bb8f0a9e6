"""Yield stress by the strain rate, after Cowper and Symonds or after Johnson and Cook.

A fibre that flows at the rate p' has the yield stress

    Y (1 + (p'/D)^(1/q))               Cowper and Symonds, D in 1/s
    Y (1 + C ln(p'/D)), Y below D      Johnson and Cook, D their reference rate, often 1/s

with Y = S_y + H_i p, p the equivalent plastic strain (PEEQ); D = 0 stands for no dependence on the
rate. In reverse they are laws of viscoplasticity, p' = D (overstress/Y)^q (Perzyna's) and
p' = D exp(overstress/(C Y)), which are solved implicitly in the time step (backward Euler), and are
stable at any. The overstress does work, which is summed up by the trapezoidal rule and counts as
dissipated. The contact's yield stress: contact/rate.py.

Sources: Cowper, Symonds, Brown University, Applied Mathematics Report 28 (1957); Perzyna, Advances
in Applied Mechanics 9 (1966) 243; Johnson, Cook, 7th International Symposium on Ballistics (1983)
541. All as remembered.
"""

import math
from typing import NamedTuple

from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

_NEWTON_STEPS = 60
_ROUND_OFF = 1e-13


class RateLaw(NamedTuple):
    """D (1/s; 0: no dependence), q and C: of Cowper and Symonds where C is 0."""

    D: float = 0.0
    q: float = 0.0
    C: float = 0.0


@compiled
def rate_law(case: Record) -> RateLaw:
    """Return the law of a case's beam."""
    if case.beam_rate_sensitivity > 0.0:
        return RateLaw(case.beam_reference_rate, 0.0, case.beam_rate_sensitivity)
    return RateLaw(case.beam_rate_coefficient, case.beam_rate_exponent, 0.0)


@compiled
def rate_factor(rate: float, law: RateLaw) -> float:
    """Return the yield stress at a strain rate (1/s), over the static one."""
    if law.C > 0.0:
        return 1.0 + law.C * math.log(max(rate / law.D, 1.0))
    return 1.0 + (rate / law.D) ** (1.0 / law.q) if law.D > 0.0 else 1.0


@compiled
def overstress(
    trial: float, Y: float, H_i: float, stiffness: float, dt: float, law: RateLaw
) -> tuple[float, float]:
    """Return s = overstress/Y at the end of a step of dt (s), and the PEEQ that flows in it.

    trial: the stress (Pa) relative to the back stress if nothing flowed, above Y. s is the root of
    trial = Y (1 + s) + flow(s): a PEEQ of dt p'(s) takes (stiffness + H_i (1 + s)) times it off the
    trial stress. Concave and falling, so that Newton's method comes down to the root from above.
    After Johnson and Cook s is 0 where less than dt D flows.
    """
    D_dt, static = law.D * dt, (trial - Y) / (stiffness + H_i)
    if law.C == 0.0:
        s = min(trial / Y - 1.0, (static / D_dt) ** (1.0 / law.q))
    elif static <= D_dt:
        return 0.0, static
    else:
        s = min(trial / Y - 1.0, law.C * math.log(static / D_dt))
    for _ in range(_NEWTON_STEPS):
        slip = _flow(s, D_dt, law)
        growth = slip / law.C if law.C > 0.0 else law.q * slip / s
        modulus = stiffness + H_i * (1.0 + s)
        slope = Y + H_i * slip + modulus * growth
        step = (trial - Y * (1.0 + s) - modulus * slip) / slope
        s += step
        if abs(step) <= _ROUND_OFF * s:
            break
    return s, _flow(s, D_dt, law)


@compiled
def _flow(s: float, D_dt: float, law: RateLaw) -> float:
    return D_dt * math.exp(s / law.C) if law.C > 0.0 else D_dt * s**law.q
