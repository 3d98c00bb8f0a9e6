"""Hunt and Crossley's impact on a rigidly backed half-space, by its first integral.

m v dv/dd = -k d^1.5 (1 + a v), a = (3/2) alpha, has v and d apart:

    (m/a^2) (a v - ln(1 + a v)) + (2/5) k d^2.5 is the same all the way.

At the deepest point v is zero; at the end d is, and v = -s/a with the same (1 - s) exp(s) as
(1 + r) exp(-r) at the beginning, r = a v_0, which Lambert's W solves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import minimize_scalar
from scipy.special import lambertw

ALPHA = 0.08
"""The solver's, in s/m."""


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
