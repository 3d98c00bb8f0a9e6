"""Impact of a sphere on a half-space, or on a mass on a spring: Hertz, Hunt and Crossley.

Source: H. Hertz (1882); K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 11.4.

Hunt and Crossley's m v dv/dd = -k d^1.5 (1 + a v), a = (3/2) alpha, has v and d apart:

    (m/a^2) (a v - ln(1 + a v)) + (2/5) k d^2.5 is the same all the way.

At the deepest point v is zero; at the end d is, and v = -s/a with the same (1 - s) exp(s) as
(1 + r) exp(-r) at the beginning, r = a v_0, which Lambert's W solves.

On a mass, by a general integrator: m_s w_s'' = m_s g - F, m w'' = F - K w, F = k delta^1.5 while
delta = w_s - w > 0; all at rest at first touch but for the sphere. Symbols: w_s, w (m),
displacements of sphere and mass; F (N). The beam as one mass on one spring has both from its static
deflection under a mid-span load, of the shape phi(x) = (3 x L^2 - 4 x^3)/L^3 up to mid-span,
mirrored beyond, 1 at mid-span. Moving as w phi(x), the beam has the energy (1/2) m w'^2 with

    m = 2 rho A * integral of phi^2 over [0, L/2] = rho A L (9/3 - 6/5 + 1/7)/4 = (17/35) rho A L,

and the bending energy of the load at mid-span, (1/2) K w^2 with K = 48 EI/L^3. Its frequency,
sqrt(K/m) = 9.941 sqrt(EI/(rho A))/L^2, is Rayleigh's estimate, 0.7 % above pi^2.
Sources: Rayleigh, The Theory of Sound I, for the method; the spring-mass models of Goldsmith,
Impact (1960), and Wang et al.; integrator: scipy's DOP853 (Hairer, Norsett and Wanner, Solving
Ordinary Differential Equations I (1993), section II.10).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from scipy.special import gamma, lambertw

from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.types import Floats

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


@dataclass(frozen=True)
class LumpedSolution:
    """Histories are at any times through `at`; displacements and forces are positive downwards.

    contacts: start and end of each in s, shape (contacts, 2), NaN where the duration ends first.
    peak_force in N at time_of_peak_force in s: the largest, of all contacts. duration in s.
    """

    impact: Impact
    duration: float
    contacts: Floats
    peak_force: float
    time_of_peak_force: float
    _path: Callable[[Floats], Floats]

    @property
    def contact_duration(self) -> float:
        """Duration of the first contact in s, NaN where it does not end."""
        return float(self.contacts[0, 1])

    def at(self, history: str, time: ArrayLike) -> Floats:
        """Return the named history at `time` (s, shape (n,)), in SI units, shape (n,).

        Raises ValueError when a time is outside the solution's, KeyError for another name.
        """
        seconds = np.atleast_1d(np.asarray(time, dtype=np.float64))
        if not np.all((seconds >= 0) & (seconds <= self.duration)):
            raise ValueError(f"time: every value must be within 0 to {self.duration!r} s")
        w_s, w, v_s, v = self._path(seconds)
        histories: dict[str, Floats] = {
            "contact_force": np.asarray(_force(w_s - w, contact_stiffness(self.impact))),
            "midspan_deflection": w,
            "indentation": w_s - w,
            "sphere_displacement": w_s,
            "sphere_velocity": v_s,
            "midspan_velocity": v,
        }
        return histories[history]


def solve(
    impact: Impact, duration: float, mass: float = math.inf, stiffness: float = 0.0
) -> LumpedSolution:
    """Solve the impact over `duration` (s) on a `mass` (kg) on a spring of `stiffness` (N/m).

    An infinite mass does not move: a rigid beam. The beam gives E* alone.

    Raises ValueError when the contact is not "hertz".
    """
    if impact.contact != "hertz":
        raise ValueError(f"Impact.contact = {impact.contact!r}: lumped masses need 'hertz'")
    k, striker, v0 = contact_stiffness(impact), impact.sphere.total_mass, impact.velocity

    def motion(_: float, state: Floats) -> list[float]:
        w_s, w, v_s, v = state
        F = _force(w_s - w, k)
        return [v_s, v, impact.gravity - F / striker, (F - stiffness * w) / mass]

    def touch_and_parting(_: float, state: Floats) -> float:
        return float(state[0] - state[1])

    def turn(_: float, state: Floats) -> float:
        return float(state[2] - state[3])

    turn.direction = -1.0  # type: ignore[attr-defined]
    args, tolerance = arguments(impact), 1e-12
    depth = maximum_indentation(*args)
    solution = solve_ivp(
        motion,
        (0.0, duration),
        [0.0, 0.0, v0, 0.0],
        method="DOP853",
        rtol=tolerance,
        atol=tolerance * np.array([depth, depth, v0, v0]),
        max_step=contact_duration(*args) / 50,  # no contact is stepped over
        events=(touch_and_parting, turn),
        dense_output=True,
    )
    touches, turns = solution.t_events
    later = touches[touches > 0.0]  # the first touch is at 0
    ends = np.concatenate(([0.0], later, [np.nan] * ((later.size + 1) % 2)))
    depths = [state[0] - state[1] for state in (*solution.y_events[1], solution.y[:, -1])]
    deepest = int(np.argmax(depths))
    contacts = np.asarray(ends.reshape(-1, 2))
    peak, time = float(_force(depths[deepest], k)), float([*turns, duration][deepest])
    return LumpedSolution(impact, duration, contacts, peak, time, solution.sol)


def _force(delta: Any, k: float) -> Any:
    """Return the Hertz force in N at an indentation (m), zero out of contact."""
    depth = np.maximum(delta, 0.0)
    return k * depth * np.sqrt(depth)


def spring_mass(beam: Beam) -> tuple[float, float]:
    """Return m = (17/35) rho A L in kg and K = 48 EI/L^3 in N/m."""
    mass = 17.0 / 35.0 * beam.mass_per_length * beam.span
    return mass, 48.0 * beam.bending_stiffness / beam.span**3


def solve_spring_mass(impact: Impact, duration: float) -> LumpedSolution:
    """Solve the beam's spring-mass model over `duration` (s); yield stresses are ignored."""
    return solve(impact, duration, *spring_mass(impact.beam))
