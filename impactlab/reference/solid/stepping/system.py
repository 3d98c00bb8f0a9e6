"""The quarter model in motion: nodes, elements, masses, and one step of all of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from impactlab.model.impact import Impact
from impactlab.reference.solid.contact.impulses import close_gaps
from impactlab.reference.solid.elements.lanes import SCRATCH, W
from impactlab.reference.solid.mesh import SPHERE, Mesh
from impactlab.reference.solid.mesh.mesh import Floats, Integers
from impactlab.reference.solid.stepping.groups import Group, make_groups
from impactlab.reference.solid.stepping.kick import kick
from impactlab.reference.solid.stepping.masses import nodal_masses
from impactlab.reference.solid.stepping.parts import Parts


class System:
    """Positions x (n, 3) in m and velocities v (n, 3) in m/s, half a step apart, from first touch.

    groups: the elements. mass: (n,) in kg. impulse, lost, beyond: of the last step's contact, see
    close_gaps. All arrays are changed in place.
    """

    def __init__(self, mesh: Mesh, impact: Impact, parts: Parts) -> None:
        """At first touch: the sphere moving at the impact's velocity, the beam at rest."""
        self.mesh, self.parts = mesh, parts
        self.x, self.v = mesh.nodes.copy(), np.zeros_like(mesh.nodes)
        self.groups, self.forces = _share_forces(make_groups(mesh, impact))
        self.mass = nodal_masses(mesh, impact)
        self.inverse_mass = _inverse(self.mass, mesh)
        self.starts, self.slots = _slots(self.groups, len(mesh.nodes))
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
            for group in self.groups:
                blocks = self.parts.share(part, group.blocks)
                group.kernel(
                    blocks,
                    group.nodes,
                    self.x,
                    self.v,
                    dt,
                    group.metal,
                    group.state,
                    group.forces,
                    self._scratch[part],
                )

        self.parts.run(work)

    def move(self, kick_dt: float, dt: float) -> None:
        """The nodes take up the elements' forces for kick_dt (s) and move on by dt; contact."""

        def work(part: int) -> None:
            kick(
                self.parts.share(part, len(self.x)),
                self.starts,
                self.slots,
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


def _share_forces(groups: list[Group]) -> tuple[list[Group], Floats]:
    """The groups with their forces in one array, and that array by node: (8 elements, 3)."""
    ends = np.cumsum([0, *(len(group.forces) for group in groups)])
    every = np.zeros((ends[-1], 24))
    shared = [
        replace(group, forces=every[start:end])
        for group, start, end in zip(groups, ends[:-1], ends[1:], strict=True)
    ]
    return shared, every.reshape(-1, 3)


def _slots(groups: list[Group], nodes: int) -> tuple[Integers, Integers]:
    """Where each node's forces are, see kick; in the elements' order."""
    corners, rows, first = [], [], 0
    for group in groups:
        count = group.elements.size
        own = group.nodes.reshape(-1, 8, W).transpose(0, 2, 1).reshape(-1, 8)[:count]
        corners.append(own.ravel())
        rows.append(8 * first + np.arange(8 * count))
        first += len(group.forces)
    every = np.concatenate(corners)
    order = np.argsort(every, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=nodes))])
    return starts.astype(np.int32), np.concatenate(rows)[order].astype(np.int32)
