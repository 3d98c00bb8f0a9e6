"""The infinite elastic Euler-Bernoulli beam struck at x = 0, by an impulse or by a given force.

Source: J. Boussinesq (1885); the Fourier integral of mu w_tt + EI w_xxxx = J delta(x) delta(t),
w(x, t) = J/(pi mu k) * integral of sin(k q^2 t) cos(q x)/q^2 over q > 0, k = sqrt(EI/mu),
mu = rho A. All of it holds for a beam of finite span until the supports' echo is back.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fresnel

from impactlab.model.bodies import Beam
from impactlab.types import Floats


def deflection_under_impulse(beam: Beam, impulse: float, time: ArrayLike) -> Floats:
    """Return w(0, t) = J sqrt(t)/(mu sqrt(2 pi k)) in m.

    The deflection where an `impulse` J (N s) struck at t = 0, at each `time` (s, any shape).
    """
    return _scale(beam, impulse) * np.sqrt(np.asarray(time, dtype=np.float64))


def profile_under_impulse(beam: Beam, impulse: float, time: ArrayLike, x: ArrayLike) -> Floats:
    """Return w(x, t) in m at each distance `x` (m) from where an `impulse` J (N s) struck.

    w(x, t) = w(0, t) (cos(a^2) + sin(a^2) - sqrt(2 pi) a (C - S)), a = |x|/(2 sqrt(k t)), with
    Fresnel's integrals C and S at a sqrt(2/pi): w_xx of the Fourier integral, integrated twice.
    time (s) and x broadcast.
    """
    seconds = np.asarray(time, dtype=np.float64)
    a = np.abs(np.asarray(x, dtype=np.float64)) / (2.0 * np.sqrt(_wave_constant(beam) * seconds))
    S, C = fresnel(a * math.sqrt(2.0 / math.pi))
    shape = np.cos(a**2) + np.sin(a**2) - math.sqrt(2.0 * math.pi) * a * (C - S)
    return np.asarray(_scale(beam, impulse) * np.sqrt(seconds) * shape)


def deflection_under_force(beam: Beam, time: Floats, force: Floats) -> Floats:
    """Return w(0, t) in m at each `time` (s, shape (n,), ascending) under a `force` (N, (n,)).

    The response to an impulse convolved with the force, exactly so for a force that begins at zero
    and is linear between the times: every kink begins a ramp, and a ramp of s (N/s) leaves
    (4/15) s t^2.5/(mu sqrt(2 pi k)).
    """
    return _scale(beam, 4.0 / 15.0) * _ramps(time, force, 2.5)


def curvature_under_force(beam: Beam, time: Floats, force: Floats) -> Floats:
    """Return w_xx(0, t) = -w_t(0, t)/k in 1/m; see deflection_under_force."""
    return -_scale(beam, 2.0 / 3.0) / _wave_constant(beam) * _ramps(time, force, 1.5)


def _wave_constant(beam: Beam) -> float:
    """Return k in m2/s."""
    return math.sqrt(beam.bending_stiffness / beam.mass_per_length)


def _scale(beam: Beam, impulse: float) -> float:
    """Return J/(mu sqrt(2 pi k)), in m s^-0.5 for J in N s."""
    root = math.sqrt(2.0 * math.pi * _wave_constant(beam))
    return impulse / (beam.mass_per_length * root)


def _ramps(time: Floats, force: Floats, power: float) -> Floats:
    """Sum over the kinks of a force, before each time: change of slope x (time since)^power."""
    kinks = np.diff(np.diff(force) / np.diff(time), prepend=0.0)
    since = np.maximum(time[:, np.newaxis] - time[:-1], 0.0)
    return np.asarray(since**power @ kinks)
