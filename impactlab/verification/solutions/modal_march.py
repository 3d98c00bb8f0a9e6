"""March of the sphere and the beam's modes in time, under Hertz contact.

Each body is carried over a step exactly, the force taken as linear over the step, and the force at
the step's end is solved for to round-off: second order in the step.
Source: the integral equation of S. Timoshenko, Z. Math. Phys. 62 (1913) 198, mode by mode.

Symbols: y, v, displacement (m) and velocity (m/s) of a body: the sphere, or the beam's mid-span in
one mode; h, step (s); k, Hertz stiffness (N m^-1.5); F, contact force (N); delta, indentation (m).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import BeamModes


@dataclass(frozen=True)
class Path:
    """F (N) and delta (m) of shape (time,), y (m) and v (m/s) of shape (time, bodies).

    Body 0 is the sphere, the others are the modes.
    """

    force: Floats
    indentation: Floats
    y: Floats
    v: Floats


def march(impact: Impact, modes: BeamModes, h: float, steps: int, compliance: float = 0.0) -> Path:
    """Return the histories over `steps` steps of `h` (s) from first touch, under Hertz contact.

    compliance: see modal.solve_with.
    """
    move, k = _motion(impact, modes, h), hertz.contact_stiffness(impact)
    bodies = move.fall.size
    approach = np.concatenate(([1.0], -np.ones(bodies - 1)))
    flexibility = modes.residual_flexibility + compliance - float(approach @ move.position[3])
    force, indentation = np.zeros(steps + 1), np.zeros(steps + 1)
    y, v = np.zeros((steps + 1, bodies)), np.zeros((steps + 1, bodies))
    v[0, 0] = impact.velocity
    for i in range(steps):
        free = move.position[0] * y[i] + move.position[1] * v[i] + move.position[2] * force[i]
        kept = move.rate[0] * y[i] + move.rate[1] * v[i] + move.rate[2] * force[i]
        free += move.fall
        indentation[i + 1], force[i + 1] = _contact(float(approach @ free), flexibility, k)
        y[i + 1] = free + move.position[3] * force[i + 1]
        v[i + 1] = kept + move.gain + move.rate[3] * force[i + 1]
    return Path(force, indentation, y, v)


@dataclass(frozen=True)
class _Motion:
    """One step of every body, exact for linear F; body 0 is the sphere, the others are the modes.

    y at the step's end is position[0] y + position[1] v + position[2] F + position[3] F_end + fall,
    and v likewise with rate and gain. Shapes: (4, bodies) and (bodies,).
    """

    position: Floats
    rate: Floats
    fall: Floats
    gain: Floats


def _motion(impact: Impact, modes: BeamModes, h: float) -> _Motion:
    mass, g = impact.sphere.total_mass, impact.gravity
    position, rate = _mode_motion(modes, h)
    sphere_position = [1.0, h, -h * h / (3.0 * mass), -h * h / (6.0 * mass)]
    sphere_rate = [0.0, 1.0, -0.5 * h / mass, -0.5 * h / mass]
    weight = np.eye(1, modes.frequencies.size + 1)[0] * g
    return _Motion(
        np.column_stack((sphere_position, position)),
        np.column_stack((sphere_rate, rate)),
        0.5 * h * h * weight,
        h * weight,
    )


def _mode_motion(modes: BeamModes, h: float) -> tuple[Floats, Floats]:
    """Return Duhamel's integral over a step: the modes' share of position and rate."""
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
