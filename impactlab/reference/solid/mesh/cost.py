"""What a run on a mesh will cost, before anything is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from impactlab.model.impact import Impact
from impactlab.reference.solid.mesh.mesh import BEAM, SPHERE, Mesh

ONE_POINT_SECONDS, FULL_SECONDS = 200e-9, 500e-9
"""Of one core for an element's step, its nodes' included: the slower of two machines, on meshes
that its caches do not hold; a small mesh on the faster one takes half."""
_ONE_POINT_BYTES, _FULL_BYTES, _NODE_BYTES = 700, 1600, 250


@dataclass(frozen=True)
class Cost:
    """elements, steps: counts. cpu_seconds: on one core. memory_bytes: at the most."""

    elements: int
    steps: int
    cpu_seconds: float
    memory_bytes: int


def estimate(mesh: Mesh, impact: Impact, *, duration: float) -> Cost:
    """The cost of `duration` (s) on `mesh`, from its smallest elements and measured times."""
    steps = int(np.ceil(duration / time_step(mesh, impact)))
    full = int(mesh.full.sum())
    one_point = len(mesh.elements) - full
    seconds = steps * (one_point * ONE_POINT_SECONDS + full * FULL_SECONDS)
    memory = one_point * _ONE_POINT_BYTES + full * _FULL_BYTES + len(mesh.nodes) * _NODE_BYTES
    return Cost(len(mesh.elements), steps, seconds, memory)


def time_step(mesh: Mesh, impact: Impact) -> float:
    """About the largest stable step in s: the time a pressure wave takes over the shortest edge."""
    points = mesh.nodes[mesh.elements]
    shortest = np.full(len(points), np.inf)
    for one, other in ((0, 1), (0, 3), (0, 4), (6, 2), (6, 5), (6, 7)):
        edge = np.linalg.norm(points[:, one] - points[:, other], axis=1)
        shortest = np.minimum(shortest, edge)
    steps = []
    for body, steel in ((BEAM, impact.beam.material), (SPHERE, impact.sphere.material)):
        nu = steel.poissons_ratio
        modulus = steel.youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
        steps.append(float(shortest[mesh.body == body].min()) / np.sqrt(modulus / steel.density))
    return float(0.9 * min(steps))
