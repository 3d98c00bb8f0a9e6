"""Radial return onto von Mises's yield surface with isotropic and kinematic hardening.

Yield where sqrt(3/2) |s - a| = sigma_y + H_i p: s the deviatoric stress, a the back stress, p the
equivalent plastic strain; da = 2/3 H_k d(plastic strain), so that both moduli are uniaxial slopes.
With linear hardening the backward Euler step has this closed form.
Source: M. L. Wilkins (1964); J. C. Simo and T. J. R. Hughes, Computational Inelasticity (1998),
box 3.1.
"""

from __future__ import annotations

import math

from impactlab.fem3d.solver.jit import inlined

Six = tuple[float, float, float, float, float, float]
Metal = tuple[float, float, float, float, float, float, float]
"""E, nu, G, K, sigma_y, H_i, H_k: all but nu in Pa."""


@inlined
def mises(s: Six) -> float:
    """sqrt(3/2 s:s) of a deviator."""
    shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
    return math.sqrt(1.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * shear))


@inlined
def radial_return(trial: Six, a: Six, p: float, metal: Metal) -> tuple[Six, Six, float, float]:
    """s, a, dp and the xx component of the plastic strain's increment, from an elastic trial s."""
    _, _, G, _, sigma_y, H_i, H_k = metal
    xi = less(trial, 1.0, a)
    q = mises(xi)
    dp = max(q - (sigma_y + H_i * p), 0.0) / (3.0 * G + H_i + H_k)
    flow = 1.5 * dp / max(q, 1e-300)  # plastic strain over xi
    return less(trial, 2.0 * G * flow, xi), less(a, -2.0 / 3.0 * H_k * flow, xi), dp, flow * xi[0]


@inlined
def less(a: Six, factor: float, b: Six) -> Six:
    """a - factor b."""
    return (
        a[0] - factor * b[0],
        a[1] - factor * b[1],
        a[2] - factor * b[2],
        a[3] - factor * b[3],
        a[4] - factor * b[4],
        a[5] - factor * b[5],
    )
