"""What Kratos' steps leave behind."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from impactlab.fem3d.solver.mesh.mesh import Floats


class Moment(NamedTuple):
    """At the end of a step: time in s, contact force of all four quarters in N.

    Displacements in m, positive downwards: of the sphere's centre of mass and of its pole, of the
    beam's axis and of its top below the impact. velocity: of the sphere's centre of mass in m/s,
    downwards. iterations: Newton's, in this step.
    """

    time: float
    force: float
    sphere: float
    pole: float
    axis: float
    top: float
    velocity: float
    iterations: float


@dataclass
class History:
    """moments: one a step and one before. stopped: why before its time, else ""."""

    moments: list[Moment] = field(default_factory=list)
    stopped: str = ""
    cpu_seconds: float = 0.0

    def table(self) -> Floats:
        """The moments, (8, steps + 1)."""
        return np.array(self.moments).T
