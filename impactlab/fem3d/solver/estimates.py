"""Estimates made before a run: how far contact and plastic flow reach, and what the run costs.

The mesh is laid out by the reach. A run checks both: a contact at the rim of the patch stops it,
and elements that are not fully integrated yield by the same law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from impactlab.model.bodies import Beam
from impactlab.model.checks import positive
from impactlab.model.impact import HINGES, MID_SPAN, Impact
from impactlab.model.material import Material
from impactlab.verification.solutions import hertz

if TYPE_CHECKING:
    from impactlab.fem3d.solver.mesh import Mesh


def checked_size(impact: Impact, element_size: float) -> float:
    """Return an element size in m. Raises ValueError where no mesh could ever have it."""
    size = positive("mesh", "element_size", element_size)
    if size < (finest := 1e-5 * impact.sphere.radius):
        raise ValueError(
            f"mesh.element_size = {size!r} m: must be at least {finest:.2g} m, "
            "a hundred-thousandth of the sphere's radius"
        )
    return size


def ends(beam: Beam) -> tuple[str, str]:
    """Return what holds the left and the right end; a roller is pinned, for it moves along."""
    left, right = beam.support_left, beam.support_right
    return "pinned" if left in HINGES else left, "pinned" if right in HINGES else right


def end_springs(beam: Beam) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the springs of the left and of the right end: N/m, and N m; zeros unless elastic."""
    left = beam.stiffness_left, beam.rotational_stiffness_left
    right = beam.stiffness_right, beam.rotational_stiffness_right
    none = 0.0, 0.0
    return (
        left if beam.support_left == "elastic" else none,
        right if beam.support_right == "elastic" else none,
    )


def copies(impact: Impact) -> int:
    """Return the number of equal parts of beam and sphere: 4 quarters or 2 halves."""
    left, right = zip(ends(impact.beam), end_springs(impact.beam), strict=True)
    return 4 if left == right and impact.strike_position == MID_SPAN else 2


def contact_radius(impact: Impact) -> float:
    """Return the largest contact radius in m to expect, of an elastic and a plastic half-space.

    Hertz: a = sqrt(R delta_m). Plastic: F = pi a^2 p with a^2 = 2 R delta takes up m v^2/2 at
    a^4 = 2 R m v^2/(pi p), p = 2.8 (Tabor) of the softer body's yield stress. A beam gives way and
    stays below the larger one.
    """
    mass, velocity, _, radius = values = hertz.arguments(impact)
    depth = hertz.maximum_indentation(*values)
    pressure = 2.8 * min(impact.sphere.material.yield_stress, impact.beam.material.yield_stress)
    plastic = math.pow(2.0 * radius * mass * velocity**2 / (math.pi * pressure), 0.25)
    return max(math.sqrt(radius * depth), plastic)


def largest_patch(impact: Impact) -> float:
    """Return the largest patch in m that fits on beam and sphere."""
    beam, place = impact.beam, impact.strike_position
    shorter = min(place, 1.0 - place) * beam.span
    return min(0.9 * beam.width / 2.0, 0.45 * impact.sphere.radius, shorter / 2.0)


def uniform(size: float, length: float) -> int:
    """Return the number of intervals of at most `size` in `length` (both in m), at least 1."""
    return max(math.ceil(length / size * (1.0 - 1e-9)), 1)


def checked_patch(impact: Impact, element_size: float, patch: float | None) -> float:
    """Return half the side of the square of matched nodes in m, rounded up to whole elements.

    patch: None for an estimate of at least 3 elements, a quarter above the contact radius to expect
    or, where the bodies end, less. Raises ValueError where it is not positive, or does not fit on
    beam and sphere.
    """
    room = largest_patch(impact)
    if patch is None:
        radius = contact_radius(impact)
        half = element_size * max(math.ceil(1.25 * radius / element_size), 3)
        fits = element_size * math.floor(room / element_size)
        if fits >= max(radius, 3.0 * element_size):
            half = min(half, fits)
    else:
        half = element_size * uniform(element_size, positive("mesh", "patch", patch))
    if half > room:
        raise ValueError(
            f"mesh.patch = {half:.4g} m, of whole elements: must be at most {room:.4g} m to fit on "
            "beam and sphere; a smaller patch, element_size or velocity may"
        )
    return half


def damped_step(step: float, beta: float) -> float:
    """Return a step (s) as far from instability as `step` is without damping of the stiffness.

    beta: in s, see springs.py.
    """
    return step if beta == 0.0 else step**2 / (beta + math.hypot(beta, step))


ONE_POINT_SECONDS, FULL_SECONDS = 170e-9, 350e-9
"""Time per element and step on one core, nodes included, on meshes that the caches of a busy
machine do not hold; a small mesh takes half."""
_DAMPED = 1.7  # time with damping of the beam's stiffness, over that without
_BYTES = 1000  # approximate memory per element, with its share of the nodes
_ONE_POINT_BYTES, _FULL_BYTES, _NODE_BYTES = 700, 1600, 250


@dataclass(frozen=True)
class Cost:
    """The cost of a run. cpu_seconds: on one core. memory_bytes: at most."""

    elements: int
    steps: int
    cpu_seconds: float
    memory_bytes: int


def estimate(mesh: Mesh, impact: Impact, *, duration: float) -> Cost:
    """Return the cost of `duration` (s) on `mesh`, from its smallest elements and measurements.

    The largest stable step is about that of a pressure wave over the shortest edge, or shorter
    where springs are stiff or the stiffness is damped.
    """
    # which import this module
    from impactlab.fem3d.solver.mesh import nodal_masses
    from impactlab.fem3d.solver.springs import springs_of

    points = mesh.nodes[mesh.elements]
    ends = ((0, 1), (0, 3), (0, 4), (6, 2), (6, 5), (6, 7))
    edges = [np.linalg.norm(points[:, start] - points[:, end], axis=1) for start, end in ends]
    shortest = np.min(edges, axis=0)
    stable = []
    for body, (steel, density) in enumerate(_metals(impact)):
        nu = steel.poissons_ratio
        modulus = steel.youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
        stable.append(float(shortest[mesh.body == body].min()) / np.sqrt(modulus / density))
    springs, mass = springs_of(mesh, impact), nodal_masses(mesh, impact)
    sprung = np.max(springs.diagonal(len(mass)) / mass[:, np.newaxis])  # 1/s2
    step = min(stable) / np.sqrt(1.0 + 0.25 * sprung * min(stable) ** 2)
    beta = impact.beam.stiffness_damping
    steps = int(np.ceil(duration / damped_step(float(0.9 * step), beta)))
    full = int(mesh.full.sum())
    one_point = len(mesh.elements) - full
    seconds = steps * (one_point * ONE_POINT_SECONDS + full * FULL_SECONDS)
    seconds *= 1.0 if beta == 0.0 else _DAMPED
    memory = one_point * _ONE_POINT_BYTES + full * _FULL_BYTES + len(mesh.nodes) * _NODE_BYTES
    return Cost(len(mesh.elements), steps, seconds, memory)


def least_cost(
    impact: Impact, *, element_size: float, duration: float, patch: float | None = None
) -> Cost:
    """Return the least cost of a mesh without making it; arguments as those of impact_mesh.

    A cube of elements on either side of the contact, and the beam in the largest that there are:
    its transitions, which are left out, may be more. Raises ValueError as impact_mesh.
    """
    size = checked_size(impact, element_size)
    beam, parts = impact.beam, copies(impact)
    half = checked_patch(impact, size, patch)
    far = beam.span / parts * beam.section.area / max(beam.depth / 6.0, size) ** 3
    near = 8.0 / parts * (half / size) ** 3
    fastest = max(math.sqrt(steel.youngs_modulus / density) for steel, density in _metals(impact))
    beta = beam.stiffness_damping
    steps = int(duration / damped_step(size / fastest, beta)) + 1
    seconds = steps * (near * FULL_SECONDS + far * ONE_POINT_SECONDS)
    return Cost(int(near + far), steps, seconds, int(near + far) * _BYTES)


def _metals(impact: Impact) -> list[tuple[Material, float]]:
    """Return material and density in kg/m3 of beam and sphere, whose density follows its mass."""
    beam, sphere = impact.beam.material, impact.sphere
    density = sphere.total_mass / (4.0 / 3.0 * math.pi * sphere.radius**3)
    return [(beam, beam.density), (sphere.material, density)]
