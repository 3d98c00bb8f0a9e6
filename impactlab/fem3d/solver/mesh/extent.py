"""How far contact and plastic flow will reach: estimates that the mesh is laid out by.

Both are checked while a run goes: a contact at the patch's rim stops it, and elements that are not
fully integrated yield by the same law.
"""

from __future__ import annotations

import math

from impactlab.fem3d.solver.mesh.grading import uniform
from impactlab.model.checks import positive
from impactlab.model.impact import Impact
from impactlab.verification.solutions import hertz

_HARDNESS = 2.8
"""Mean pressure of a fully plastic contact over the yield stress (Tabor)."""
_FINEST = 1e-5
"""Of an element, over the sphere's radius."""
_MARGIN = 1.25
"""Patch over the estimated contact radius."""


def checked_size(impact: Impact, element_size: float) -> float:
    """An element size in m. Raises ValueError where no mesh could ever have it."""
    size = positive("mesh", "element_size", element_size)
    if size < (finest := _FINEST * impact.sphere.radius):
        raise ValueError(
            f"mesh.element_size = {size!r} m: must be at least {finest:.2g} m, "
            "a hundred-thousandth of the sphere's radius"
        )
    return size


def contact_radius(impact: Impact) -> float:
    """Largest contact radius in m to expect: of an elastic and of a plastic half-space.

    Hertz: a = sqrt(R delta_m). Plastic: F = pi a^2 p with a^2 = 2 R delta takes up m v^2/2 at
    a^4 = 2 R m v^2/(pi p), p = 2.8 of the softer body's yield stress. A beam gives way and stays
    below the larger one.
    """
    radius, mass = hertz.effective_radius(impact), impact.sphere.total_mass
    modulus = hertz.effective_modulus(impact)
    depth = hertz.maximum_indentation(mass, impact.velocity, modulus, radius)
    softer = min(impact.sphere.material.yield_stress, impact.beam.material.yield_stress)
    pressure = _HARDNESS * softer
    plastic = math.pow(2.0 * radius * mass * impact.velocity**2 / (math.pi * pressure), 0.25)
    return max(math.sqrt(radius * depth), plastic)


def patch_size(impact: Impact, element_size: float) -> float:
    """Half the side of the square of matched nodes in m: a whole number of elements, at least 3.

    Its margin is cut where the bodies end, down to the contact radius to expect.
    """
    radius = contact_radius(impact)
    half = element_size * max(math.ceil(_MARGIN * radius / element_size), 3)
    least = max(radius, 3.0 * element_size)
    fits = element_size * math.floor(largest_patch(impact) / element_size)
    return min(half, fits) if fits >= least else half


def largest_patch(impact: Impact) -> float:
    """What beam and sphere have room for, in m."""
    beam = impact.beam
    return min(0.9 * beam.width / 2.0, 0.45 * impact.sphere.radius, beam.span / 4.0)


def checked_patch(impact: Impact, element_size: float, patch: float | None) -> float:
    """The patch in m, rounded up to whole elements (None: estimated).

    Raises ValueError where it is not positive, or does not fit on beam and sphere.
    """
    if patch is None:
        half = patch_size(impact, element_size)
    else:
        half = element_size * uniform(element_size, positive("mesh", "patch", patch))
    if half > (room := largest_patch(impact)):
        raise ValueError(
            f"mesh.patch = {half:.4g} m, of whole elements: must be at most {room:.4g} m to fit on "
            "beam and sphere; a smaller patch, element_size or velocity may"
        )
    return half


def bending_yields(impact: Impact) -> bool:
    """Whether the beam may yield in bending: an infinite beam whose middle moves at `velocity`.

    M = v sqrt(rho A EI) there, the yield moment at v = sigma_y/sqrt(3 rho E).
    """
    steel = impact.beam.material
    limit = steel.yield_stress / math.sqrt(3.0 * steel.density * steel.youngs_modulus)
    return impact.velocity > limit
