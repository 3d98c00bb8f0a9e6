"""Impact of a sphere on a half-space: Hertz's closed forms, and Hunt and Crossley's with damping.

Source: H. Hertz (1882); K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 11.4.

Hunt and Crossley's m v dv/dd = -k d^1.5 (1 + a v), a = (3/2) alpha, has v and d apart:

    (m/a^2) (a v - ln(1 + a v)) + (2/5) k d^2.5 is the same all the way.

At the deepest point v is zero; at the end d is, and v = -s/a with the same (1 - s) exp(s) as
(1 + r) exp(-r) at the beginning, r = a v_0, which Lambert's W solves.
"""

import math
from dataclasses import dataclass

from scipy.optimize import minimize_scalar
from scipy.special import gamma, lambertw

from impactlab.model.impact import Impact

CONTACT_TIME_FACTOR = float(2.0 * math.sqrt(math.pi) * gamma(1.4) / gamma(0.9))
"""t_c v/delta_m = 2 * integral of (1 - s^2.5)^(-1/2) over [0, 1] = 2.9433."""


def effective_modulus(impact: Impact) -> float:
    """Return E* in Pa, from 1/E* = (1 - nu_s^2)/E_s + (1 - nu_b^2)/E_b."""
    sphere, beam = (
        (1.0 - material.poissons_ratio**2) / material.youngs_modulus
        for material in (impact.sphere.material, impact.beam.material)
    )
    return 1.0 / (sphere + beam)


def stiffness(modulus: float, radius: float) -> float:
    """Return the stiffness k in N m^-1.5 of F = k delta^1.5, from E* (Pa) and R* (m)."""
    return 4.0 / 3.0 * modulus * math.sqrt(radius)


def contact_stiffness(impact: Impact) -> float:
    """Return the Hertz stiffness k in N m^-1.5 of the two bodies of `impact`."""
    return stiffness(effective_modulus(impact), impact.sphere.radius)


def maximum_indentation(mass: float, velocity: float, modulus: float, radius: float) -> float:
    """Return delta_m = (15 m v^2/(16 E* sqrt(R*)))^(2/5) in m; kg, m/s, Pa, m."""
    return math.pow(15.0 * mass * velocity**2 / (16.0 * modulus * math.sqrt(radius)), 0.4)


def peak_force(mass: float, velocity: float, modulus: float, radius: float) -> float:
    """Return the contact force in N at delta_m; kg, m/s, Pa, m."""
    indentation = maximum_indentation(mass, velocity, modulus, radius)
    return stiffness(modulus, radius) * math.pow(indentation, 1.5)


def contact_duration(mass: float, velocity: float, modulus: float, radius: float) -> float:
    """Return t_c = 2.9433 delta_m/v in s, with the exact constant; kg, m/s, Pa, m."""
    return CONTACT_TIME_FACTOR * maximum_indentation(mass, velocity, modulus, radius) / velocity


def arguments(impact: Impact) -> tuple[float, float, float, float]:
    """Return (mass, velocity, E*, R*) of `impact`, as the closed forms take them."""
    sphere = impact.sphere
    return sphere.total_mass, impact.velocity, effective_modulus(impact), sphere.radius


ALPHA = 0.08
"""The solver's damping of a viscous contact, in s/m."""


@dataclass(frozen=True)
class HuntCrossleyImpact:
    """A sphere of `mass` (kg) at `velocity` (m/s) on F = k d^1.5 (1 + a d'), k in N/m^1.5."""

    mass: float
    velocity: float
    k: float
    alpha: float = ALPHA

    @property
    def restitution(self) -> float:
        """The coefficient of restitution."""
        r = 1.5 * self.alpha * self.velocity
        return (1.0 + float(lambertw(-(1.0 + r) * math.exp(-1.0 - r)).real)) / r

    def indentation(self, velocity: float) -> float:
        """Return the indentation (m) where the sphere is still as fast as `velocity` (m/s)."""
        a = 1.5 * self.alpha
        lost = a * (self.velocity - velocity)
        lost -= math.log((1.0 + a * self.velocity) / (1.0 + a * velocity))
        return float((2.5 * self.mass * lost / (a**2 * self.k)) ** 0.4)

    @property
    def maximum_indentation(self) -> float:
        """The largest indentation in m."""
        return self.indentation(0.0)

    def force(self, velocity: float) -> float:
        """Return the force (N) where the sphere is still as fast as `velocity` (m/s)."""
        damped = 1.0 + 1.5 * self.alpha * velocity
        return self.k * damped * math.pow(self.indentation(velocity), 1.5)

    @property
    def peak_force(self) -> float:
        """The largest force in N, before the largest indentation."""
        bounds, accuracy = (0.0, self.velocity), {"xatol": 1e-9 * self.velocity}
        best = minimize_scalar(
            lambda v: -self.force(v), bounds=bounds, method="bounded", options=accuracy
        )
        return -float(best.fun)
