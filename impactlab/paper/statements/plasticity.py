"""What the statements on plastic strain share: after what time, and where in the beam."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.paper.statements.claim import Data, Number
from impactlab.paper.statements.curves import Curve, against_velocity
from impactlab.paper.statements.evidence import number, runs_of

LIMIT = 0.002
"""The plastic strain that the paper compares with."""


class Reading(NamedTuple):
    """A way to take the paper's words: which study, which response; literal: the nearest one."""

    words: str
    study: str
    response: str
    literal: bool


_LATE, _EARLY = "fig10_nodes", "fig10_first"
AWAY = (
    Reading(
        "away from the impact, after all contacts (25 ms)", _LATE, "remote_plastic_strain", True
    ),
    Reading("away from the impact, after 1 ms", _EARLY, "remote_plastic_strain", False),
)
"""Farther than one beam depth from the impact: the paper does not say how far, nor when."""
ANYWHERE = (
    Reading(
        "anywhere in the beam, after all contacts (25 ms)", _LATE, "peak_plastic_strain", False
    ),
    Reading("anywhere in the beam, after 1 ms", _EARLY, "peak_plastic_strain", False),
)
"""Under the sphere, too."""


def strain(data: Data, reading: Reading, velocity: float) -> Number:
    """The largest PEEQ there at a velocity (m/s). Raises UnknownError where a run is missing."""
    found = number(runs_of(data, reading.study), reading.response, velocity=velocity)
    return Number(f"PEEQ at {velocity:g} m/s", found.value, "1", found.uncertainty)


def strains(data: Data, reading: Reading) -> Curve:
    """The largest PEEQ there against the velocity. Raises UnknownError where a run is missing."""
    return against_velocity(data, reading.study, reading.response)


def beginning(curve: Curve) -> tuple[float, float]:
    """The largest velocity without plastic strain below the first with it, and that one.

    NaN for what there is none of.
    """
    plastic = curve.value > 0
    first = int(np.argmax(plastic)) if plastic.any() else plastic.size
    below = float(curve.velocity[first - 1]) if first else float("nan")
    return below, float(curve.velocity[first]) if plastic.any() else float("nan")
