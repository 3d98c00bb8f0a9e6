"""Hertz's impact of a finite sphere, to first order in contact radius over radius.

The sphere's surface answers a pressure p_n P_n(cos theta) with a radial displacement (A. I.
Lur'e, Three-Dimensional Problems of the Theory of Elasticity, chapter 6); n = 1 is balanced by
inertia, and taken from the centre of mass. What this gives beyond a half-space, under Hertz's
pressure, is an extra compliance (here below zero: stiffer).
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from impactlab.verification.solutions import hertz

_MODES = 20_000


def extra_compliance(radius, contact_radius, E, nu):
    """Return the extra compliance in m/N, for lengths in m and E in Pa."""
    n, G = np.arange(2.0, _MODES), E / (2.0 * (1.0 + nu))
    lame = 2.0 * G * nu / (1.0 - 2.0 * nu)
    upper = 4.0 * n**2 - 2.0 - 4.0 * nu * n**2 + 4.0 * nu + 2.0 * nu * n
    modes = upper / (4.0 * G * (n - 1.0) * (n**2 + n + 1.0 + nu * (2.0 * n + 1.0)))
    modes = np.concatenate([[(1.0 - 2.0 * nu) / E, 1.2 / (6.0 * lame + 4.0 * G)], modes])
    k = np.arange(_MODES) + 0.5
    x = k * contact_radius / radius
    pressure = 3.0 * (np.sin(x) - x * np.cos(x)) / x**3
    half_space = (1.0 - nu) / (G * k)
    return np.sum(k * (modes - half_space) * pressure**2) / (2.0 * math.pi * radius)


def impact(case):
    """Return peak force in N and contact duration in s of an impact on an elastic half-space."""
    ball, mass = case.sphere, case.sphere.total_mass
    arguments = mass, case.velocity, hertz.effective_modulus(case), ball.radius
    deepest, long = hertz.maximum_indentation(*arguments), hertz.contact_duration(*arguments)
    steel, contact_radius = ball.material, math.sqrt(ball.radius * deepest)
    extra = extra_compliance(
        ball.radius, contact_radius, steel.youngs_modulus, steel.poissons_ratio
    )
    k = hertz.stiffness(*arguments[2:])

    def force(approach):
        if approach <= 0.0:
            return 0.0
        top = 2.0 * k * (2.0 * approach) ** 1.5
        return brentq(lambda F: (F / k) ** (2.0 / 3.0) + extra * F - approach, 0.0, top)

    def leaves(_, state):
        return state[0]

    leaves.terminal, leaves.direction = True, -1
    path = solve_ivp(
        lambda _, state: (state[1], -force(state[0]) / mass),
        (0.0, 2.0 * long),
        (0.0, case.velocity),
        rtol=1e-8,
        atol=1e-14,
        max_step=long / 200.0,
        events=leaves,
    )
    return max(map(force, path.y[0])), path.t[-1]
