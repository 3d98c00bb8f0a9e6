"""A sphere strikes one mass on one spring under Hertz contact, by a general integrator.

m_s w_s'' = m_s g - F, m w'' = F - K w, F = k delta^1.5 while delta = w_s - w > 0; all at rest at
first touch but for the sphere. Symbols: w_s, w (m), displacements of sphere and mass; F (N).

The beam as one mass on one spring has both from its static deflection under a mid-span load, of the
shape phi(x) = (3 x L^2 - 4 x^3)/L^3 up to mid-span, mirrored beyond, 1 at mid-span. Moving as
w phi(x), the beam has the kinetic energy (1/2) m w'^2 with

    m = 2 rho A * integral of phi^2 over [0, L/2]
      = rho A L * integral of (3 s - s^3)^2/4 over [0, 1],  s = 2 x/L,
      = rho A L (9/3 - 6/5 + 1/7)/4 = (17/35) rho A L,

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

from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.verification.solutions import hertz


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
            "contact_force": np.asarray(_force(w_s - w, hertz.contact_stiffness(self.impact))),
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
    k, striker, v0 = hertz.contact_stiffness(impact), impact.sphere.total_mass, impact.velocity

    def motion(_: float, state: Floats) -> list[float]:
        w_s, w, v_s, v = state
        F = _force(w_s - w, k)
        return [v_s, v, impact.gravity - F / striker, (F - stiffness * w) / mass]

    def touch_and_parting(_: float, state: Floats) -> float:
        return float(state[0] - state[1])

    def turn(_: float, state: Floats) -> float:
        return float(state[2] - state[3])

    turn.direction = -1.0  # type: ignore[attr-defined]
    args, tolerance = hertz.arguments(impact), 1e-12
    depth = hertz.maximum_indentation(*args)
    solution = solve_ivp(
        motion,
        (0.0, duration),
        [0.0, 0.0, v0, 0.0],
        method="DOP853",
        rtol=tolerance,
        atol=tolerance * np.array([depth, depth, v0, v0]),
        max_step=hertz.contact_duration(*args) / 50,  # no contact is stepped over
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
