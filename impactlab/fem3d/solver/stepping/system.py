"""The quarter model in motion: nodes, elements, masses, and one step of all of them."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.contact.impulses import close_gaps
from impactlab.fem3d.solver.elements.lanes import SCRATCH, W
from impactlab.fem3d.solver.mesh import SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.stepping.groups import make_groups
from impactlab.fem3d.solver.stepping.kick import kick
from impactlab.fem3d.solver.stepping.masses import nodal_masses
from impactlab.fem3d.solver.stepping.parts import Parts
from impactlab.fem3d.solver.stepping.rows import MOST_THREADS, blocks_of, force_rows
from impactlab.model.impact import Impact


class System:
    """Positions x (n, 3) in m and velocities v (n, 3) in m/s, half a step apart, from first touch.

    groups: the elements. mass: (n,) in kg. impulse, lost, beyond: of the last step's contact, see
    close_gaps. All arrays are changed in place.
    """

    def __init__(self, mesh: Mesh, impact: Impact, parts: Parts) -> None:
        """At first touch: the sphere moving at the impact's velocity, the beam at rest."""
        self.mesh, self.parts = mesh, parts
        self.x, self.v = mesh.nodes.copy(), np.zeros_like(mesh.nodes)
        self.groups = make_groups(mesh, impact)
        self.rows = force_rows(self.groups, len(mesh.nodes))
        self.forces = np.zeros((self.rows.count, 3))
        self.mass = nodal_masses(mesh, impact)
        self.inverse_mass = _inverse(self.mass, mesh)
        sphere = np.unique(mesh.elements[mesh.body == SPHERE])
        self.v[sphere, 2] = -impact.velocity
        self.pull = np.zeros(len(mesh.nodes))
        self.pull[sphere] = impact.gravity
        self.approach = self._approach()
        self.impulse, self.lost, self.beyond = 0.0, 0.0, False
        self._scratch = [np.zeros(SCRATCH * W) for _ in range(parts.threads)]

    def strain(self, dt: float) -> None:
        """The elements take up a motion of dt (s) with v, which has led to x."""

        def work(part: int) -> None:
            pieces = self.parts.share(part, MOST_THREADS)
            for group, rows in zip(self.groups, self.rows.of_groups, strict=True):
                group.kernel(
                    blocks_of(group, *pieces),
                    group.nodes,
                    rows,
                    self.x,
                    self.v,
                    dt,
                    group.metal,
                    group.state,
                    self.forces,
                    self._scratch[part],
                )

        self.parts.run(work)

    def move(self, kick_dt: float, dt: float) -> None:
        """The nodes take up the elements' forces for kick_dt (s) and move on by dt; contact."""

        def work(part: int) -> None:
            kick(
                self.parts.share(part, len(self.x)),
                self.rows.starts,
                self.rows.slots,
                self.forces,
                self.inverse_mass,
                self.pull,
                self.x,
                self.v,
                kick_dt,
                dt,
            )

        self.parts.run(work)
        self.impulse, self.lost, self.beyond = close_gaps(
            self.mesh.pairs,
            self.mesh.rim,
            self.inverse_mass,
            self.x,
            self.v,
            dt,
            self.approach,
        )

    def _approach(self) -> Floats:
        upper, lower = self.mesh.pairs.T
        return np.ascontiguousarray(self.v[lower, 2] - self.v[upper, 2])


def _inverse(mass: Floats, mesh: Mesh) -> Floats:
    inverse = np.repeat(1.0 / mass[:, None], 3, axis=1)
    inverse[mesh.symmetry_x, 0] = 0.0
    inverse[mesh.symmetry_y, 1] = 0.0
    inverse[mesh.support, 2] = 0.0
    return inverse
