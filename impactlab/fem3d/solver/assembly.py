"""Groups of elements in SIMD blocks, and the assembly of their nodal forces.

Each node has one row of forces per piece of a group that it belongs to. Two threads never add to
the same row, and the order of all sums is that of the mesh: a group is cut into the same pieces for
any number of threads, so the number of threads changes no bit of the results.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from impactlab.fem3d.solver.elements import (
    DISSIPATED,
    FULL_ROWS,
    HOURGLASS_WORK,
    ONE_POINT_ROWS,
    WORK,
    full_forces,
    one_point_forces,
)
from impactlab.fem3d.solver.hexahedron import W
from impactlab.fem3d.solver.jit import Array
from impactlab.fem3d.solver.material import POINT_ROWS, Metal
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import Integers
from impactlab.model.impact import Impact, Material


@dataclass(frozen=True, eq=False)
class Group:
    """Elements of one body with the same number of integration points.

    elements: (g,) numbers in the mesh. nodes: (blocks, 8 W), the last element repeated to fill.
    state: (blocks, rows W), the rows of the points first.
    """

    elements: Array
    nodes: Array
    points: int
    kernel: Callable[..., None]
    metal: Metal
    state: Array

    @property
    def blocks(self) -> int:
        """Return the number of blocks."""
        return len(self.nodes)

    def of_elements(self, row: int) -> Array:
        """Return a row of `state` after those of the points, by element: (g,)."""
        return self._row(self.points * POINT_ROWS + row)

    def of_points(self, row: int) -> Array:
        """Return one row of every integration point, (points, g)."""
        return np.stack([self._row(point * POINT_ROWS + row) for point in range(self.points)])

    def _row(self, row: int) -> Array:
        values = self.state.reshape(self.blocks, -1, W)[:, row]
        return values.reshape(-1)[: self.elements.size]

    def works(self) -> Array:
        """Return the works in J of all elements: of stresses, dissipated, against hourglassing."""
        rows = (WORK, DISSIPATED, HOURGLASS_WORK)
        return np.array([self.of_elements(row).sum() for row in rows])


def make_groups(mesh: Mesh, impact: Impact) -> list[Group]:
    """Return the groups at rest, without empty ones."""
    metals = {BEAM: metal(impact.beam.material), SPHERE: metal(impact.sphere.material)}
    return [
        make_group(mesh.elements, np.flatnonzero(chosen), whole, metals[body])
        for body in (BEAM, SPHERE)
        for whole in (True, False)
        if np.any(chosen := (mesh.body == body) & (mesh.full == whole))
    ]


def make_group(elements: Array, numbers: Array, whole: bool, steel: Metal) -> Group:
    """Return a group at rest of these numbers of the elements; whole: fully integrated."""
    blocks = -(-numbers.size // W)
    filled = np.append(numbers, np.repeat(numbers[-1], blocks * W - numbers.size))
    nodes = elements[filled].reshape(blocks, W, 8).transpose(0, 2, 1).reshape(blocks, 8 * W)
    return Group(
        elements=numbers,
        nodes=np.ascontiguousarray(nodes),
        points=8 if whole else 1,
        kernel=full_forces if whole else one_point_forces,
        metal=steel,
        state=np.zeros((blocks, (FULL_ROWS if whole else ONE_POINT_ROWS) * W)),
    )


def metal(material: Material) -> Metal:
    """Return E, nu, G, K, sigma_y, H_i, H_k."""
    E, nu = material.youngs_modulus, material.poissons_ratio
    return (
        E,
        nu,
        E / (2.0 * (1.0 + nu)),
        E / (3.0 * (1.0 - 2.0 * nu)),
        material.yield_stress,
        material.isotropic_hardening_modulus,
        material.kinematic_hardening_modulus,
    )


MOST_THREADS = 24
"""Pieces of a group: it is shared equally by 2, 3, 4, 6, 8 or 12 threads, too."""


@dataclass(frozen=True, eq=False)
class ForceAssembly:
    """Rows of forces, (count, 3).

    of_groups: like Group.nodes, the rows in place of the nodes. starts: (n + 1,);
    slots[starts[i]:starts[i + 1]]: the rows of node i.
    """

    of_groups: list[Array]
    starts: Integers
    slots: Integers
    count: int


def blocks_of(group: Group, first: int, end: int) -> tuple[int, int]:
    """Return the blocks of a group's pieces from `first` to before `end`."""
    return group.blocks * first // MOST_THREADS, group.blocks * end // MOST_THREADS


def force_assembly(groups: Sequence[Group], nodes: int) -> ForceAssembly:
    """Return the rows of force for the elements of all groups, on that many nodes."""
    of_groups, owners = [], []
    count = 0
    for group in groups:
        rows = np.empty_like(group.nodes)
        for piece in range(MOST_THREADS):
            blocks = slice(*blocks_of(group, piece, piece + 1))
            own, place = np.unique(group.nodes[blocks], return_inverse=True)
            rows[blocks] = count + place.reshape(rows[blocks].shape)
            owners.append(own)
            count += own.size
        spare = len(group.nodes) * W - group.elements.size
        rows.reshape(-1, 8, W)[-1, :, W - spare :] = count  # what fills the last block adds nothing
        owners.append(np.array([nodes]))
        count += 1
        of_groups.append(rows)
    every = np.concatenate(owners)
    starts = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=nodes)[:nodes])])
    slots = np.argsort(every, kind="stable")[: starts[-1]]
    return ForceAssembly(of_groups, starts.astype(np.int32), slots.astype(np.int32), count)
