"""Stronge's law on a rigidly backed half-space: the work of loading in closed form.

Loading in three phases (elastic, elastic-plastic, fully plastic), unloading with force continuity.
Sources: W. J. Stronge, Impact Mechanics (2000), section 6.4, for loading; Wang et al., as the paper
takes it (its Table 1 and Eqs. 15 to 17), for unloading. No gravity, no waves in the half-space.

Unloading leaves a bulge and not a dent for 1 < x < 1.998, and gives back more than was put in for
1 < x < 2.673 (a restitution of at most 1.101, at x = 1.415), whatever the bodies: there the law
itself creates energy.

Symbols: delta_y (m) and F_y (N), indentation and force at first yield; x = delta/delta_y,
u = 2 x - 1.
"""

import math

from scipy.optimize import brentq

from impactlab.model.impact import Impact
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.contact_laws import LawOnHalfSpace

CONSTRAINT = 1.1  # th: mean contact pressure over yield stress at first yield
HARDNESS = 2.8  # mean contact pressure over yield stress when fully plastic
U_PLASTIC = math.exp(3.0 * (HARDNESS - CONSTRAINT))
"""u = 164.02 (x = 82.511), where the two plastic branches meet without a jump."""


class StrongeImpact(LawOnHalfSpace):
    """Stronge's law of two bodies: E* and sigma_y (of the softer body) in Pa, R* in m."""

    def __init__(self, modulus: float, radius: float, yield_stress: float) -> None:
        """Take the bodies; the law does not depend on Poisson's ratio."""
        super().__init__("stronge", modulus, radius, yield_stress, math.nan)

    @property
    def yield_indentation(self) -> float:
        """delta_y = (3 pi th sigma_y/(4 E*))^2 R* in m."""
        pressure = CONSTRAINT * self.yield_stress
        return (0.75 * math.pi * pressure / self.effective_modulus) ** 2 * self.effective_radius

    @property
    def yield_force(self) -> float:
        """F_y = (4/3) E* sqrt(R*) delta_y^1.5 in N."""
        stiffness = hertz.stiffness(self.effective_modulus, self.effective_radius)
        return stiffness * math.pow(self.yield_indentation, 1.5)

    def loading_work(self, indentation: float) -> float:
        """Return the energy in J put in up to a monotonically reached `indentation` (m)."""
        x = indentation / self.yield_indentation
        return self.yield_force * self.yield_indentation * _work(x)

    def maximum_indentation(self, velocity: float, mass: float) -> float:
        """Return delta_m in m, where the loading work is the energy of `mass` (kg)."""
        energy = 0.5 * mass * velocity**2
        scaled = energy / (self.yield_force * self.yield_indentation)
        if scaled <= 0.4:
            return self.yield_indentation * math.pow(scaled / 0.4, 0.4)
        # F >= F_y u, hence the work is at least 0.4 + (u^2 - 1)/4: this bounds u.
        limit = 0.5 + 0.5 * math.sqrt(1.0 + 4.0 * scaled)
        root = brentq(lambda x: _work(x) - scaled, 1.0, limit, xtol=1e-13, rtol=1e-14)
        return self.yield_indentation * float(root)


def stronge_impact(impact: Impact) -> StrongeImpact:
    """Return the bodies of `impact` on a half-space; its contact law and gravity are ignored."""
    return StrongeImpact(
        hertz.effective_modulus(impact),
        impact.sphere.radius,
        min(impact.sphere.material.yield_stress, impact.beam.material.yield_stress),
    )


def _work(x: float) -> float:
    """Return the loading work over F_y delta_y."""
    if x <= 1.0:
        return 0.4 * math.pow(x, 2.5)
    u = 2.0 * x - 1.0
    mixed = min(u, U_PLASTIC)
    logarithm = mixed**2 * math.log(mixed) / 2.0 - mixed**2 / 4.0 + 0.25
    elastic_plastic = ((mixed**2 - 1.0) / 2.0 + logarithm / (3.0 * CONSTRAINT)) / 2.0
    return 0.4 + elastic_plastic + HARDNESS / CONSTRAINT * (u**2 - mixed**2) / 4.0
