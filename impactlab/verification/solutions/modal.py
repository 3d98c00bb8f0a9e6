"""Elastic beam struck at mid-span under Hertz contact: the modal series.

For the beam of Euler and Bernoulli and that of Timoshenko, the latter with both spectra of modes.
Sources: S. Timoshenko, Zur Frage nach der Wirkung eines Stosses auf einen Balken, Z. Math. Phys. 62
(1913) 198, whose integral equation is solved mode by mode; Goldsmith, Impact (1960); S. Timoshenko,
Phil. Mag. 43 (1922) 125, for shear.

Symbols: y, v, displacement (m) and velocity (m/s) of a body: the sphere, or the beam's mid-span in
one mode; h, step (s); k, Hertz stiffness (N m^-1.5); F, contact force (N); delta, indentation (m).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import BeamModes, odd_modes, timoshenko_odd_modes


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


def solve(
    impact: Impact, duration: float, *, modes: int = 50, step: float | None = None
) -> ModalSolution:
    """Solve the impact on an elastic beam over `duration` (s), with `modes` odd modes.

    step: largest step in s; default: a thousandth of Hertz's contact time on a half-space, which
    leaves a relative error below 1e-6 in peak force and contact duration (it falls with step^2).
    All yield stresses are ignored. A duration within the first contact gives the peak so far.

    Raises ValueError when the contact is not "hertz".
    """
    return solve_with(odd_modes(impact.beam, modes), impact, duration, step)


def solve_timoshenko(
    impact: Impact, duration: float, *, modes: int = 100, step: float | None = None
) -> ModalSolution:
    """Solve the impact on an elastic Timoshenko beam over `duration` (s), with `modes` odd n.

    step as in solve. Errors fall with modes^-3; in the paper's case 100 leave below 1e-7 of peak
    force and contact duration, and 1e-5 of the largest curvature. amplitudes and rates of the
    solution have the shape (time, 2 modes): the lower spectrum, then the higher one.

    Raises ValueError as solve does.
    """
    return solve_with(timoshenko_odd_modes(impact.beam, modes), impact, duration, step)


def solve_with(
    modes: BeamModes,
    impact: Impact,
    duration: float,
    step: float | None,
    compliance: float = 0.0,
    bending: float = 0.0,
) -> ModalSolution:
    """Solve the impact on the beam that has these modes; the rest as in solve.

    compliance (m/N), bending (m2): approach of sphere and axis beyond Hertz's half-spaces per force
    and per -w_xx at mid-span; negative where the bodies end.
    """
    if impact.contact != "hertz":
        raise ValueError(f"Impact.contact = {impact.contact!r}: the modal series needs 'hertz'")
    if step is None:
        step = hertz.contact_duration(*hertz.arguments(impact)) / 1000.0
    steps = max(math.ceil(duration / step), 4)
    local = compliance, bending
    force, depth, y, v = _march(impact, modes, duration / steps, steps, local)
    curvature = modes.residual_curvature * force + y[:, 1:] @ modes.curvatures
    time = np.linspace(0.0, duration, steps + 1)
    delta, amplitudes = CubicSpline(time, depth), y[:, 1:]
    turns = np.append(delta.derivative().roots(extrapolate=False), time[-1])
    peak_time = float(turns[np.argmax(delta(turns))])
    roots = delta.roots(extrapolate=False)
    roots = roots[roots > 0.5 * time[1]]  # the first touch is at 0
    ends = np.concatenate(([0.0], roots, [np.nan] * ((roots.size + 1) % 2)))
    approach = depth + compliance * force - bending * curvature
    return ModalSolution(
        modes=modes,
        time=time,
        contact_force=force,
        midspan_deflection=y[:, 0] - approach,
        midspan_curvature=curvature,
        sphere_displacement=y[:, 0],
        sphere_velocity=v[:, 0],
        indentation=approach,
        amplitudes=amplitudes,
        rates=v[:, 1:],
        contacts=np.asarray(ends.reshape(-1, 2)),
        peak_force=hertz.contact_stiffness(impact) * float(delta(peak_time)) ** 1.5,
        time_of_peak_force=peak_time,
    )


def _march(
    impact: Impact, modes: BeamModes, h: float, steps: int, local: tuple[float, float]
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return F, delta (time,) and y, v (time, bodies) over `steps` steps of `h` (s).

    Body 0 is the sphere, the others are the modes. Each is carried over a step exactly, the force
    taken as linear over the step: y at the step's end is position[0] y + position[1] v +
    position[2] F + position[3] F_end + fall, and v likewise with rate and gain. The force at the
    step's end is solved for to round-off: second order in the step.
    """
    k, mass = hertz.contact_stiffness(impact), impact.sphere.total_mass
    position, rate = _duhamel(modes, h)
    sphere_position = [1.0, h, -h * h / (3.0 * mass), -h * h / (6.0 * mass)]
    sphere_rate = [0.0, 1.0, -0.5 * h / mass, -0.5 * h / mass]
    position = np.column_stack((sphere_position, position))
    rate = np.column_stack((sphere_rate, rate))
    bodies = modes.frequencies.size + 1
    weight = np.eye(1, bodies)[0] * impact.gravity
    fall, gain = 0.5 * h * h * weight, h * weight
    compliance, bending = local
    approach = np.concatenate(([1.0], bending * modes.curvatures - 1.0))
    flexibility = modes.residual_flexibility + compliance - bending * modes.residual_curvature
    flexibility -= float(approach @ position[3])
    force, depth = np.zeros(steps + 1), np.zeros(steps + 1)
    y, v = np.zeros((steps + 1, bodies)), np.zeros((steps + 1, bodies))
    v[0, 0] = impact.velocity
    for i in range(steps):
        free = position[0] * y[i] + position[1] * v[i] + position[2] * force[i]
        free_rate = rate[0] * y[i] + rate[1] * v[i] + rate[2] * force[i]
        free += fall
        depth[i + 1], force[i + 1] = _contact(float(approach @ free), flexibility, k)
        y[i + 1] = free + position[3] * force[i + 1]
        v[i + 1] = free_rate + gain + rate[3] * force[i + 1]
    return force, depth, y, v


def _duhamel(modes: BeamModes, h: float) -> tuple[Floats, Floats]:
    """Return Duhamel's integral over a step: the modes' position and rate, shape (4, modes)."""
    omega, flexibility, phi = modes.frequencies, modes.flexibilities, modes.frequencies * h
    cosine, sine, sinc = np.cos(phi), np.sin(phi), np.sinc(phi / np.pi)
    versine = 2.0 * np.sin(0.5 * phi) ** 2
    start, end = flexibility * (sinc - cosine), flexibility * (1.0 - sinc)
    position = np.stack((cosine, sine / omega, start, end))
    start, end = flexibility * (omega * sine - versine / h), flexibility * versine / h
    return position, np.stack((-omega * sine, cosine, start, end))


def _contact(gap: float, flexibility: float, k: float) -> tuple[float, float]:
    """Find delta and F at a step's end: the root of delta + flexibility k delta^1.5 = gap.

    gap (m): the indentation if no force acted at the step's end. A flexibility below zero is small
    beside the slope of Hertz's curve: there is one root near gap.
    """
    if gap <= 0.0:
        return gap, 0.0
    delta, change, softness = gap, gap, flexibility * k
    while abs(change) > 1e-15 * delta:
        # Convex and positive at gap, or concave and negative: Newton does not overshoot.
        root = math.sqrt(delta)
        change = (delta + softness * delta * root - gap) / (1.0 + 1.5 * softness * root)
        if change * softness <= 0.0:
            break
        delta -= change
    return delta, k * delta * math.sqrt(delta)
