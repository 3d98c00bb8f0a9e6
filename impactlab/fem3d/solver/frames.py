"""Snapshots of the plane of symmetry along the beam during a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.fem3d.solver.evaluation import fields
from impactlab.fem3d.solver.mesh import plane_faces
from impactlab.fem3d.solver.system import System

FRAMES = {
    "field_time": ("s", "time of the fields since first touch"),
    "section_position": ("m", "corners of the faces in the plane along the beam, x and z"),
    "section_plastic_strain": ("1", "equivalent plastic strain (PEEQ) of their elements"),
}
"""Units and long_name of what a run keeps."""


class Frames:
    """Displaced corners of the plane's faces, and the strain of their elements, over time."""

    def __init__(self, system: System) -> None:
        """Keep the beginning."""
        self._system = system
        mesh = system.mesh
        self._elements, self._nodes = plane_faces(mesh.nodes, mesh.elements, 1, mesh.element_size)
        self._times, self._positions, self._strains = list[float](), list[Any](), list[Any]()
        self.keep(0.0)

    def keep(self, time: float) -> None:
        """Keep the present state, as that at a time in s, unless that of this time is kept."""
        if self._times and time <= self._times[-1]:
            return
        system = self._system
        strain = fields(system.groups, len(system.mesh.elements))["equivalent_plastic_strain"]
        self._times.append(time)
        self._positions.append(system.x[self._nodes][..., [0, 2]])
        self._strains.append(strain[self._elements])

    def variables(self) -> dict[str, Any]:
        """Return the variables FRAMES."""
        dims = ("field_time", "face")
        return {
            "field_time": self._times,
            "section_position": ((*dims, "face_corner", "section_axis"), np.array(self._positions)),
            "section_plastic_strain": (dims, np.array(self._strains)),
        }
