"""What a march through time leaves behind, step by step and checkpoint by checkpoint."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from impactlab.fem3d.solver.mesh.mesh import Floats


class Moment(NamedTuple):
    """At the beginning of a step: time in s, contact force of all four quarters in N.

    Displacements in m, positive downwards: of the sphere's centre of mass and of its pole, of the
    beam's axis and of its top below the impact. velocity: of the sphere's centre of mass in m/s,
    downwards, at the middle of the step that begins.
    """

    time: float
    force: float
    sphere: float
    pole: float
    axis: float
    top: float
    velocity: float


class Energies(NamedTuple):
    """At a checkpoint, of all four quarters, in J (time in s).

    work: of the stresses in the elements, kept and dissipated. plastic: dissipated of it.
    hourglass: work against hourglassing. contact: lost in closing gaps. gravity: work done by it.
    """

    time: float
    kinetic: float
    work: float
    plastic: float
    hourglass: float
    contact: float
    gravity: float

    @property
    def balance(self) -> float:
        """What stays the same."""
        return self.kinetic + self.work + self.hourglass + self.contact - self.gravity


@dataclass
class History:
    """moments: one a step. energies: one a checkpoint. stopped: why before its time, else "".

    offset: largest distance by which matched nodes that touched had slid, over the element size.
    patch_needed: of matched nodes in m, where the contact outgrew its own; else 0.
    """

    moments: list[Moment] = field(default_factory=list)
    energies: list[Energies] = field(default_factory=list)
    stopped: str = ""
    offset: float = 0.0
    patch_needed: float = 0.0

    def table(self) -> Floats:
        """The moments, (7, steps)."""
        return np.array(self.moments).T
