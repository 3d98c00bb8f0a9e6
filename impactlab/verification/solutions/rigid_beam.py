"""A beam that neither bends nor moves: the sphere strikes a half-space, gravity included.

Without gravity it is Hertz's impact, whose closed forms are in reference.hertz.
"""

from __future__ import annotations

import math

from impactlab.model.impact import Impact
from impactlab.verification.solutions import lumped
from impactlab.verification.solutions.lumped import LumpedSolution, Oscillator


def solve(impact: Impact, duration: float) -> LumpedSolution:
    """The impact on a rigid beam of the same contact modulus over `duration` (s).

    Raises ValueError when the contact is not "hertz" or the duration is not positive.
    """
    return lumped.solve(impact, Oscillator(math.inf, 0.0), duration)
