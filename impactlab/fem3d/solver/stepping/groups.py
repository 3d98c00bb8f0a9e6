"""Elements of one body and one kind, in blocks of lanes, with all that they remember."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from impactlab.fem3d.solver.elements import full, one_point, point
from impactlab.fem3d.solver.elements.full import full_forces
from impactlab.fem3d.solver.elements.lanes import W
from impactlab.fem3d.solver.elements.one_point import one_point_forces
from impactlab.fem3d.solver.material.plasticity import Metal
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.types import Array
from impactlab.model.impact import Impact
from impactlab.model.material import Material


@dataclass(frozen=True, eq=False)
class Group:
    """elements: (g,) numbers in the mesh. nodes: (blocks, 8 W), the last element repeated to fill.

    kind: the module with the rows of `state`, (blocks, kind.ROWS W).
    """

    elements: Array
    nodes: Array
    kind: ModuleType
    kernel: Callable[..., None]
    metal: Metal
    state: Array

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.nodes)

    def row(self, row: int) -> Array:
        """One row of `state`, by element: (g,)."""
        values = self.state.reshape(self.blocks, self.kind.ROWS, W)[:, row]
        return values.reshape(-1)[: self.elements.size]

    def points(self, row: int) -> Array:
        """One row of every integration point, (points, g)."""
        starts = point.ROWS * np.arange(self.kind.POINTS)
        return np.stack([self.row(start + row) for start in starts])


def make_groups(mesh: Mesh, impact: Impact) -> list[Group]:
    """The groups at rest, those without elements left out."""
    metals = {BEAM: metal(impact.beam.material), SPHERE: metal(impact.sphere.material)}
    return [
        _group(mesh.elements, np.flatnonzero(chosen), whole, metals[body])
        for body in (BEAM, SPHERE)
        for whole in (True, False)
        if np.any(chosen := (mesh.body == body) & (mesh.full == whole))
    ]


def _group(elements: Array, numbers: Array, whole: bool, steel: Metal) -> Group:
    blocks = -(-numbers.size // W)
    filled = np.append(numbers, np.repeat(numbers[-1], blocks * W - numbers.size))
    nodes = elements[filled].reshape(blocks, W, 8).transpose(0, 2, 1).reshape(blocks, 8 * W)
    kind, kernel = (full, full_forces) if whole else (one_point, one_point_forces)
    return Group(
        elements=numbers,
        nodes=np.ascontiguousarray(nodes),
        kind=kind,
        kernel=kernel,
        metal=steel,
        state=np.zeros((blocks, kind.ROWS * W)),
    )


def metal(material: Material) -> Metal:
    """E, nu, G, K, sigma_y, H_i, H_k."""
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
