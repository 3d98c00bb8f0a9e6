"""What a run on a mesh will cost, before anything is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from impactlab.fem3d.solver.mesh.extent import checked_patch, checked_size
from impactlab.fem3d.solver.mesh.mesh import BEAM, SPHERE, Mesh
from impactlab.model.impact import Impact
from impactlab.model.material import Material

ONE_POINT_SECONDS, FULL_SECONDS = 200e-9, 500e-9
"""Of one core for an element's step, its nodes' included: the slower of two machines, on meshes
that its caches do not hold; a small mesh on the faster one takes half."""
_BYTES = 1000
"""Of an element and its share of the nodes, about."""
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


def least_cost(
    impact: Impact, *, element_size: float, duration: float, patch: float | None = None
) -> Cost:
    """What a mesh costs at the least, known without making it; arguments as those of quarter_mesh.

    A cube of elements on either side of the contact, and the beam in the largest that there are:
    its transitions, which are left out, may be more. Raises ValueError as quarter_mesh.
    """
    size = checked_size(impact, element_size)
    beam = impact.beam
    half = checked_patch(impact, size, patch)
    far = beam.span / 2.0 * beam.width / 2.0 * beam.depth / max(beam.depth / 6.0, size) ** 3
    near = 2.0 * (half / size) ** 3
    fastest = max(
        math.sqrt(steel.youngs_modulus / density) for _, steel, density in _metals(impact)
    )
    steps = int(duration * fastest / size) + 1
    seconds = steps * (near * FULL_SECONDS + far * ONE_POINT_SECONDS)
    return Cost(int(near + far), steps, seconds, int(near + far) * _BYTES)


def time_step(mesh: Mesh, impact: Impact) -> float:
    """About the largest stable step in s: the time a pressure wave takes over the shortest edge."""
    points = mesh.nodes[mesh.elements]
    shortest = np.full(len(points), np.inf)
    for one, other in ((0, 1), (0, 3), (0, 4), (6, 2), (6, 5), (6, 7)):
        edge = np.linalg.norm(points[:, one] - points[:, other], axis=1)
        shortest = np.minimum(shortest, edge)
    steps = []
    for body, steel, density in _metals(impact):
        nu = steel.poissons_ratio
        modulus = steel.youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
        steps.append(float(shortest[mesh.body == body].min()) / np.sqrt(modulus / density))
    return float(0.9 * min(steps))


def _metals(impact: Impact) -> tuple[tuple[int, Material, float], tuple[int, Material, float]]:
    """Each body's material and density in kg/m3: the sphere's is that of the mass it is given."""
    beam, sphere = impact.beam.material, impact.sphere
    density = sphere.total_mass / (4.0 / 3.0 * math.pi * sphere.radius**3)
    return (BEAM, beam, beam.density), (SPHERE, sphere.material, density)
