"""A load that grows slowly, through the public door: a heavy, slow striker with a soft contact."""

from __future__ import annotations

import math
from dataclasses import replace

from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.paper import paper_impact
from impactlab.model.sphere import Sphere

_RADIUS = 3.5


def slow_impact(beam: Beam, mass: float, velocity: float, softness: float) -> Impact:
    """A striker of `mass` (kg) at `velocity` (m/s) on `beam`, without gravity.

    Its Hertz contact gives 20 kN at an indentation of `softness` (m), and F ~ delta^1.5 starts
    without a jump in the rate of loading, so that the beam follows without swinging.
    """
    stiffness = 20e3 / softness**1.5
    modulus = (1.0 - 0.3**2) * 0.75 * stiffness / math.sqrt(_RADIUS)  # the beam is rigid beside it
    soft = Material(
        density=7800.0, youngs_modulus=modulus, poissons_ratio=0.3, yield_stress=0.1 * modulus
    )
    sphere = Sphere(radius=_RADIUS, material=soft, mass=mass)
    return replace(
        paper_impact(velocity, "hertz"), sphere=sphere, beam=beam, gravity=0.0, velocity=velocity
    )
