"""Elastic beam struck at mid-span under Hertz contact: the modal series.

For the beam of Euler and Bernoulli and that of Timoshenko, the latter with both spectra of modes.
Sources: S. Timoshenko, Zur Frage nach der Wirkung eines Stosses auf einen Balken, Z. Math. Phys. 62
(1913) 198; Goldsmith, Impact (1960); S. Timoshenko, Phil. Mag. 43 (1922) 125, for shear. Modes in
beam_modes, march in time in modal_march.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from impactlab.model.checks import positive
from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import BeamModes, odd_modes, timoshenko_odd_modes
from impactlab.verification.solutions.modal_march import Path, march


@dataclass(frozen=True)
class ModalSolution:
    """Histories of shape (time,) in SI units; displacements and forces positive downwards.

    midspan_curvature: of bending at mid-span, w_xx or Timoshenko's psi_x, in 1/m, negative while
    the beam sags. amplitudes, rates: of each mode at mid-span, in m and m/s, shape (time, modes).
    contacts: start and end of each in s, shape (contacts, 2), NaN where the duration ends first.
    indentation: the approach of sphere and beam axis. The peak is taken between steps.
    """

    modes: BeamModes
    time: Floats
    contact_force: Floats
    midspan_deflection: Floats
    midspan_curvature: Floats
    sphere_displacement: Floats
    sphere_velocity: Floats
    indentation: Floats
    amplitudes: Floats
    rates: Floats
    contacts: Floats
    peak_force: float
    time_of_peak_force: float

    @property
    def contact_duration(self) -> float:
        """Duration of the first contact in s, NaN where it does not end."""
        return float(self.contacts[0, 1])

    def at(self, history: str, time: ArrayLike) -> Floats:
        """Return the named history at other times (s, shape (n,)), by cubic splines between steps.

        Raises ValueError when a time is outside the solution's.
        """
        seconds = np.atleast_1d(np.asarray(time, dtype=np.float64))
        if not np.all((seconds >= 0) & (seconds <= self.time[-1])):
            raise ValueError(f"time: every value must be within 0 to {self.time[-1]!r} s")
        return np.asarray(CubicSpline(self.time, getattr(self, history))(seconds))

    def deflection(self, x: ArrayLike, time: ArrayLike) -> Floats:
        """Return w(x, t) in m, shape (time, x), at distances `x` from a support (m) and times (s).

        Raises ValueError when an x is off the beam or a time is outside the solution's.
        """
        span = self.modes.beam.span
        distance = np.atleast_1d(np.asarray(x, dtype=np.float64))
        if not np.all((distance >= 0) & (distance <= span)):
            raise ValueError(f"x: every value must be on the beam, 0 to {span!r} m")
        series = self.at("amplitudes", time) @ self.modes.shapes(distance)
        rest = np.outer(self.at("contact_force", time), self.modes.residual_shape(distance))
        return np.asarray(series + rest)


def solve(
    impact: Impact, duration: float, *, modes: int = 50, step: float | None = None
) -> ModalSolution:
    """Solve the impact on an elastic beam over `duration` (s), with `modes` odd modes.

    step: largest step in s; default: a thousandth of Hertz's contact time on a half-space, which
    leaves a relative error below 1e-6 in peak force and contact duration (it falls with step^2).
    All yield stresses are ignored. A duration within the first contact gives the peak so far.

    Raises ValueError when the contact is not "hertz", or duration, step or modes is not positive.
    """
    return solve_with(odd_modes(impact.beam, modes), impact, duration, step)


def solve_with(
    table: BeamModes,
    impact: Impact,
    duration: float,
    step: float | None,
    compliance: float = 0.0,
) -> ModalSolution:
    """Solve the impact on the beam that has these modes; the rest as in solve.

    compliance: of the contact, in m/N, beyond Hertz's half-spaces; negative where the bodies end.
    """
    if impact.contact != "hertz":
        raise ValueError(f"Impact.contact = {impact.contact!r}: the modal series needs 'hertz'")
    largest = _default_step(impact) if step is None else positive("modal", "step", step)
    steps = max(math.ceil(positive("modal", "duration", duration) / largest), 4)
    path = march(impact, table, duration / steps, steps, compliance)
    return _solution(table, path, duration, impact, compliance)


def _solution(
    modes: BeamModes, path: Path, duration: float, impact: Impact, compliance: float
) -> ModalSolution:
    time = np.linspace(0.0, duration, path.force.size)
    delta, amplitudes = CubicSpline(time, path.indentation), path.y[:, 1:]
    peak_time = _peak_time(delta)
    approach = path.indentation + compliance * path.force
    return ModalSolution(
        modes=modes,
        time=time,
        contact_force=path.force,
        midspan_deflection=path.y[:, 0] - approach,
        midspan_curvature=modes.residual_curvature * path.force + amplitudes @ modes.curvatures,
        sphere_displacement=path.y[:, 0],
        sphere_velocity=path.v[:, 0],
        indentation=approach,
        amplitudes=amplitudes,
        rates=path.v[:, 1:],
        contacts=_contacts(delta),
        peak_force=hertz.contact_stiffness(impact) * float(delta(peak_time)) ** 1.5,
        time_of_peak_force=peak_time,
    )


def _contacts(delta: CubicSpline) -> Floats:
    """Return the intervals of positive indentation: roots between steps, the first touch at 0."""
    roots = delta.roots(extrapolate=False)
    roots = roots[roots > 0.5 * delta.x[1]]
    ends = np.concatenate(([0.0], roots, [np.nan] * ((roots.size + 1) % 2)))
    return np.asarray(ends.reshape(-1, 2))


def _peak_time(delta: CubicSpline) -> float:
    """Return the time in s of the largest indentation, between steps."""
    slope = delta.derivative()
    turns = np.append(slope.roots(extrapolate=False), delta.x[-1])
    return float(turns[np.argmax(delta(turns))])


def _default_step(impact: Impact) -> float:
    return hertz.contact_duration(*hertz.arguments(impact)) / 1000.0


def solve_timoshenko(
    impact: Impact,
    duration: float,
    *,
    modes: int = 100,
    step: float | None = None,
    compliance: float = 0.0,
) -> ModalSolution:
    """Solve the impact on an elastic Timoshenko beam over `duration` (s), with `modes` odd n.

    step as in solve, compliance as in solve_with. Errors fall with modes^-3; in the
    paper's case 100 leave below 1e-7 of peak force and contact duration, and 1e-5 of the largest
    curvature. amplitudes and rates of the solution have the shape (time, 2 modes): the lower
    spectrum, then the higher one.

    Raises ValueError as solve does.
    """
    return solve_with(timoshenko_odd_modes(impact.beam, modes), impact, duration, step, compliance)
