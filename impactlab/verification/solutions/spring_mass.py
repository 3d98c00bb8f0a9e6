"""The beam as one mass on one spring, both from its static deflection under a mid-span load.

Shape: phi(x) = (3 x L^2 - 4 x^3)/L^3 up to mid-span, mirrored beyond, 1 at mid-span. Moving as
w phi(x), the beam has the kinetic energy (1/2) m w'^2 with

    m = 2 rho A * integral of phi^2 over [0, L/2]
      = rho A L * integral of (3 s - s^3)^2/4 over [0, 1],  s = 2 x/L,
      = rho A L (9/3 - 6/5 + 1/7)/4 = (17/35) rho A L,

and the bending energy of the load at mid-span, (1/2) K w^2 with K = 48 EI/L^3. Its frequency,
sqrt(K/m) = 9.941 sqrt(EI/(rho A))/L^2, is Rayleigh's estimate, 0.7 % above pi^2.
Source: Rayleigh, The Theory of Sound I, for the method; as a model of impact Goldsmith, Impact
(1960), and Wang et al.
"""

from __future__ import annotations

from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.verification.solutions import lumped
from impactlab.verification.solutions.lumped import LumpedSolution, Oscillator

MASS_SHARE = 17.0 / 35.0
"""m over the beam's mass."""


def oscillator(beam: Beam) -> Oscillator:
    """m = (17/35) rho A L in kg and K = 48 EI/L^3 in N/m."""
    return Oscillator(
        MASS_SHARE * beam.mass_per_length * beam.span,
        48.0 * beam.bending_stiffness / beam.span**3,
    )


def midspan_curvature(beam: Beam, deflection: float) -> float:
    """w_xx at mid-span in 1/m with that `deflection` (m) there: phi'' w = -12 w/L^2."""
    return -12.0 * deflection / beam.span**2


def solve(impact: Impact, duration: float) -> LumpedSolution:
    """The impact on the beam's spring-mass model over `duration` (s); yield stresses are ignored.

    Raises ValueError when the contact is not "hertz" or the duration is not positive.
    """
    return lumped.solve(impact, oscillator(impact.beam), duration)
