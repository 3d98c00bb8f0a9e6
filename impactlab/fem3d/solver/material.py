"""The metal at an integration point: J2 plasticity, and stresses that turn with the material.

Symmetric tensors are six numbers: xx, yy, zz, yz, zx, xy.

Radial return onto von Mises's yield surface with isotropic and kinematic hardening: yield where
sqrt(3/2) |s - a| = sigma_y + H_i p, with s the deviatoric stress, a the back stress and p the
equivalent plastic strain; da = 2/3 H_k d(plastic strain), so that both moduli are uniaxial slopes.
With linear hardening the backward Euler step has this closed form. Where the yield stress depends
on the rate of p, it is found by Newton's method (see slip_at_rate).
Source: M. L. Wilkins (1964); J. C. Simo and T. J. R. Hughes, Computational Inelasticity (1998),
box 3.1.
"""

import math

from impactlab.fem3d.solver.compiler import Array, compiled, inlined
from impactlab.fem3d.solver.hexahedron import Tensor, Vector, W, load, store

Six = tuple[float, float, float, float, float, float]
Metal = tuple[float, float, float, float, float, float, float]
"""E, nu, G, K, sigma_y, H_i, H_k: all but nu in Pa."""
Rate = tuple[float, float, float]
"""Cowper and Symonds' D (1/s) and q, and 0; or Johnson and Cook's reference rate (1/s), 0 and C."""


@inlined
def double_dot(a: Six, b: Six) -> float:
    """Return a:b."""
    shear = a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * shear


@inlined
def mises(s: Six) -> float:
    """Return sqrt(3/2 s:s) of a deviator."""
    return math.sqrt(1.5 * double_dot(s, s))


@compiled
def slip_at_rate(q: float, Y: float, stiffness: float, H_i: float, dt: float, rate: Rate) -> float:
    """Return dp of a step of dt (s), the root of q = stiffness dp + (Y + H_i dp) (1 + s).

    q, Y: trial and static yield stress (Pa), q > Y. s, the overstress ratio at the step's end: of
    Cowper and Symonds dp = dt D s^q, of Johnson and Cook dp = dt reference exp(s/C), or less where
    s = 0. Its equation is concave and falling: Newton's method comes down to s from above.
    """
    D, exponent, C = rate
    slip = (q - Y) / (stiffness + H_i)  # at the static yield stress
    if C > 0.0 and slip <= D * dt:
        return slip
    s = C * math.log(slip / (D * dt)) if C > 0.0 else (slip / (D * dt)) ** (1.0 / exponent)
    s = min(s, q / Y - 1.0)
    for _ in range(_NEWTON_STEPS):
        slip = D * dt * (math.exp(s / C) if C > 0.0 else s**exponent)
        growth = slip / C if C > 0.0 else exponent * slip / s
        modulus = stiffness + H_i * (1.0 + s)
        step = (q - Y * (1.0 + s) - modulus * slip) / (Y + H_i * slip + modulus * growth)
        s += step
        if abs(step) <= _ROUND_OFF * s:
            break
    return D * dt * (math.exp(s / C) if C > 0.0 else s**exponent)


@inlined
def radial_return(
    trial: Six, a: Six, p: float, metal: Metal, dt: float = 0.0, rate: Rate | None = None
) -> tuple[Six, Six, float, float]:
    """Return s, a, dp and the plastic strain increment's xx component, from an elastic trial s.

    dt: of the step (s), for the law of the strain rate.
    """
    _, _, G, _, sigma_y, H_i, H_k = metal
    xi = less(trial, 1.0, a)
    q = mises(xi)
    dp = max(q - (sigma_y + H_i * p), 0.0) / (3.0 * G + H_i + H_k)
    if rate is not None and dp > 0.0:
        dp = slip_at_rate(q, sigma_y + H_i * p, 3.0 * G + H_k, H_i, dt, rate)
    flow = 1.5 * dp / max(q, 1e-300)  # plastic strain over xi
    return less(trial, 2.0 * G * flow, xi), less(a, -2.0 / 3.0 * H_k * flow, xi), dp, flow * xi[0]


@inlined
def less(a: Six, factor: float, b: Six) -> Six:
    """Return a - factor b."""
    return (
        a[0] - factor * b[0],
        a[1] - factor * b[1],
        a[2] - factor * b[2],
        a[3] - factor * b[3],
        a[4] - factor * b[4],
        a[5] - factor * b[5],
    )


@inlined
def turned(s: Six, r: Vector) -> Six:
    """Return the tensor turned by small angles, to second order (Jaumann's rate)."""
    first = _rate(s, r)
    return less(less(s, -1.0, first), -0.5, _rate(first, r))


@inlined
def _rate(s: Six, r: Vector) -> Six:
    """Return W s - s W, where W a = r x a."""
    return (
        2.0 * (r[1] * s[4] - r[2] * s[5]),
        2.0 * (r[2] * s[5] - r[0] * s[3]),
        2.0 * (r[0] * s[3] - r[1] * s[4]),
        r[0] * (s[1] - s[2]) - r[1] * s[5] + r[2] * s[4],
        r[1] * (s[2] - s[0]) - r[2] * s[3] + r[0] * s[5],
        r[2] * (s[0] - s[1]) - r[0] * s[4] + r[1] * s[3],
    )


STRESS_ROWS = 6  # rows per point in `state`: the deviator
BACK, PEEQ, ALONG = 0, 6, 7
"""Rows of a point in `past`: back stress, PEEQ, plastic strain along the beam."""
PAST_ROWS = 8  # rows per point in `past`
_NONE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_NEWTON_STEPS, _ROUND_OFF = 60, 1e-13


@inlined
def advance(
    state: Array,
    past: Array,
    point: int,
    lane: int,
    L: Tensor,
    dt: float,
    metal: Metal,
    hardens: bool,
    rate: Rate | None,
) -> tuple[Six, float, float, float, float]:
    """Return the deviator (Pa) at a point at the step's end, works in J/m3, and what has yielded.

    The works: of the deviator, and the dissipated part of it. What has yielded: the increments of
    PEEQ and of the plastic strain along the beam, which the caller adds to `past`.

    L: dv/dx at the middle of the step, in 1/s. Stresses are updated. hardens: False leaves `past`
    alone. rate: None for a yield stress that does not depend on the strain rate.
    """
    half, third = 0.5 * dt, (L[0][0] + L[1][1] + L[2][2]) / 3.0
    strain_rate = (  # its deviator
        L[0][0] - third,
        L[1][1] - third,
        L[2][2] - third,
        0.5 * (L[1][2] + L[2][1]),
        0.5 * (L[2][0] + L[0][2]),
        0.5 * (L[0][1] + L[1][0]),
    )
    # Angles in rad by which the material turns about x, y and z in the step.
    turn = (half * (L[2][1] - L[1][2]), half * (L[0][2] - L[2][0]), half * (L[1][0] - L[0][1]))
    row, past_row = STRESS_ROWS * point, PAST_ROWS * point
    before = turned(_load(state, row, lane), turn)
    trial = less(before, -2.0 * metal[2] * dt, strain_rate)
    back, p = _NONE, 0.0
    if hardens:
        back = turned(_load(past, past_row + BACK, lane), turn)
        p = past[(past_row + PEEQ) * W + lane]
    S, back, dp, along = radial_return(trial, back, p, metal, dt, rate)
    if hardens:
        _store(past, past_row + BACK, lane, back)
    _store(state, row, lane, S)
    work = 0.5 * dt * double_dot(less(before, -1.0, S), strain_rate)
    dissipated = dp * (metal[4] + metal[5] * (p + 0.5 * dp))
    if rate is not None and dp > 0.0:  # the stress at the step's end, with its overstress
        dissipated = dp * (mises(less(S, 1.0, back)) - 0.5 * metal[5] * dp)
    return S, work, dissipated, dp, along


@inlined
def _load(state: Array, row: int, lane: int) -> Six:
    return load(state, row, lane) + load(state, row + 3, lane)


@inlined
def _store(state: Array, row: int, lane: int, s: Six) -> None:
    store(state, row, lane, (s[0], s[1], s[2]))
    store(state, row + 3, lane, (s[3], s[4], s[5]))
