"""The quarter model in motion: nodes, elements, masses, and one step of all of them on threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from impactlab.fem3d.solver.contact import close_gaps
from impactlab.fem3d.solver.elements.hexahedron import SCRATCH, W
from impactlab.fem3d.solver.jit import Array, compiled
from impactlab.fem3d.solver.mesh import SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Floats, nodal_masses
from impactlab.fem3d.solver.stepping.assembly import (
    MOST_THREADS,
    blocks_of,
    force_assembly,
    make_groups,
)
from impactlab.model.impact import Impact


class ThreadPool:
    """A pool for compiled functions over ranges of numbers; one of its threads is the caller's.

    Use it as a context: it ends its threads.
    """

    def __init__(self, threads: int) -> None:
        """Start that many threads, at least 1."""
        self.threads = threads
        self._pool = ThreadPoolExecutor(max(threads - 1, 1))

    def __enter__(self) -> ThreadPool:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    def run(self, work: Callable[[int], Any]) -> None:
        """Call work(part) for every part from 0 to threads - 1, and wait for all."""
        others = [self._pool.submit(work, part) for part in range(1, self.threads)]
        work(0)
        for other in others:
            other.result()

    def share(self, part: int, count: int) -> tuple[int, int]:
        """Return the first and the one past the last of `count` numbers that are this part's."""
        return count * part // self.threads, count * (part + 1) // self.threads


@compiled
def integrate(
    nodes: tuple[int, int],
    starts: Array,
    slots: Array,
    forces: Array,
    inverse_mass: Array,
    pull: Array,
    x: Array,
    v: Array,
    velocity_dt: float,
    dt: float,
) -> None:
    """Move the nodes from the first to before the last of `nodes`.

    starts: (n + 1,); slots[starts[i]:starts[i + 1]]: node i's rows of forces (., 3) in N, which are
    left at 0.
    inverse_mass: (n, 3) in 1/kg, 0 where a node is held. pull: (n,) downward acceleration in m/s2.
    velocity_dt, dt: seconds between the velocities and between the positions.
    """
    for node in range(nodes[0], nodes[1]):
        f0, f1, f2 = 0.0, 0.0, 0.0
        for at in range(starts[node], starts[node + 1]):
            slot = slots[at]
            f0 += forces[slot, 0]
            f1 += forces[slot, 1]
            f2 += forces[slot, 2]
            forces[slot, 0], forces[slot, 1], forces[slot, 2] = 0.0, 0.0, 0.0
        v[node, 0] -= velocity_dt * inverse_mass[node, 0] * f0
        v[node, 1] -= velocity_dt * inverse_mass[node, 1] * f1
        v[node, 2] -= velocity_dt * (inverse_mass[node, 2] * f2 + pull[node])
        x[node, 0] += dt * v[node, 0]
        x[node, 1] += dt * v[node, 1]
        x[node, 2] += dt * v[node, 2]


class System:
    """Nodes with positions x (n, 3) in m and velocities v (n, 3) in m/s, half a step apart.

    groups: the elements. mass: (n,) in kg. impulse, lost, beyond: of the last step's contact, see
    close_gaps. All arrays are changed in place.
    """

    def __init__(self, mesh: Mesh, impact: Impact, pool: ThreadPool) -> None:
        """Start at first touch: the sphere moves at the impact's velocity, the beam is at rest."""
        self.mesh, self.pool = mesh, pool
        self.x, self.v = mesh.nodes.copy(), np.zeros_like(mesh.nodes)
        self.groups = make_groups(mesh, impact)
        self.assembly = force_assembly(self.groups, len(mesh.nodes))
        self.forces = np.zeros((self.assembly.count, 3))
        self.mass = nodal_masses(mesh, impact)
        self.inverse_mass = _inverse(self.mass, mesh)
        sphere = np.unique(mesh.elements[mesh.body == SPHERE])
        self.v[sphere, 2] = -impact.velocity
        self.pull = np.zeros(len(mesh.nodes))
        self.pull[sphere] = impact.gravity
        self.approach = self._approach()
        self.impulse, self.lost, self.beyond = 0.0, 0.0, False
        self._scratch = [np.zeros(SCRATCH * W) for _ in range(pool.threads)]

    def strain(self, dt: float) -> None:
        """Strain the elements by a motion of dt (s) with v, which has led to x."""

        def work(part: int) -> None:
            pieces = self.pool.share(part, MOST_THREADS)
            for group, rows in zip(self.groups, self.assembly.of_groups, strict=True):
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

        self.pool.run(work)

    def move(self, velocity_dt: float, dt: float) -> None:
        """Apply the elements' forces for velocity_dt (s), move the nodes by dt, and close gaps."""

        def work(part: int) -> None:
            integrate(
                self.pool.share(part, len(self.x)),
                self.assembly.starts,
                self.assembly.slots,
                self.forces,
                self.inverse_mass,
                self.pull,
                self.x,
                self.v,
                velocity_dt,
                dt,
            )

        self.pool.run(work)
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
