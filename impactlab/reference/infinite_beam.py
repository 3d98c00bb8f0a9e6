"""The infinite elastic Euler-Bernoulli beam struck by an impulse.

Source: J. Boussinesq (1885); the Fourier integral of mu w_tt + EI w_xxxx = J delta(x) delta(t).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from impactlab.model.beam import Beam
from impactlab.model.checks import number


def deflection_under_impulse(beam: Beam, impulse: float, time: ArrayLike) -> NDArray[np.float64]:
    """w(0, t) = J sqrt(t)/(mu sqrt(2 pi k)) in m, k = sqrt(EI/mu), mu = rho A.

    The deflection where an `impulse` J (N s) struck at t = 0, at each `time` (s, any shape). It
    holds for a beam of finite span until the supports' echo is back.

    Raises ValueError when the impulse is not finite, or a time is negative or not finite.
    """
    seconds = np.asarray(time, dtype=np.float64)
    if not np.all(np.isfinite(seconds) & (seconds >= 0)):
        raise ValueError("time: every value must be a finite number of zero or more")
    mu = beam.mass_per_length
    k = math.sqrt(beam.bending_stiffness / mu)
    scale = number("infinite_beam", "impulse", impulse) / (mu * math.sqrt(2.0 * math.pi * k))
    return np.asarray(scale * np.sqrt(seconds))
