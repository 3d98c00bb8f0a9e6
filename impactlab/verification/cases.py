"""Impacts that more than one check uses."""

from __future__ import annotations

from dataclasses import replace

from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.paper import paper_impact
from impactlab.model.sphere import Sphere


def with_beam_material(impact: Impact, **changes: float) -> Impact:
    """`impact` on a beam of another material, its fields as in Material."""
    material = replace(impact.beam.material, **changes)
    return replace(impact, beam=replace(impact.beam, material=material))


def elastic(impact: Impact) -> Impact:
    """`impact` on a beam that never yields, under Hertz contact.

    The yield stress is raised to a tenth of Young's modulus: a strain of 0.1 is out of reach.
    """
    beyond = 0.1 * impact.beam.material.youngs_modulus
    unyielding = with_beam_material(impact, yield_stress=beyond)
    return replace(unyielding, contact="hertz")


def rigid_backed(velocity: float, contact: str) -> Impact:
    """The paper's sphere on a beam of enormous mass (E* as it is), without gravity."""
    impact = paper_impact(velocity, contact)
    return replace(with_beam_material(impact, density=7.8e9), gravity=0.0)


def aluminium_impact() -> Impact:
    """A steel sphere on a slender beam of aluminium, 400 x 30 x 12 mm."""
    aluminium = Material(
        density=2700.0, youngs_modulus=70e9, poissons_ratio=0.33, yield_stress=250e6
    )
    return Impact(
        sphere=Sphere(radius=0.015, material=paper_impact().sphere.material),
        beam=Beam(span=0.4, width=0.03, depth=0.012, material=aluminium),
        velocity=1.0,
    )


def slimmer(impact: Impact, times: float) -> Impact:
    """The same bending and contact, with depth/span so many `times` smaller.

    rho A, EI and E* stay: Young's modulus grows with the square of `times`, width makes up for
    depth, and the sphere yields what the beam's surface no longer does. To Euler and Bernoulli all
    of these are one beam; rho I/(rho A) and EI/(k G A), of rotary inertia and shear, go with
    (depth/span)^2.
    """
    beam, sphere = impact.beam, impact.sphere
    modulus, softer = beam.material.youngs_modulus, sphere.material
    share = (1.0 - beam.material.poissons_ratio**2) / modulus
    lost = share * (1.0 - 1.0 / times**2)
    own = 1.0 - softer.poissons_ratio**2
    soft = replace(softer, youngs_modulus=own / (own / softer.youngs_modulus + lost))
    slim = replace(beam, depth=beam.depth / times, width=beam.width * times)
    slim = replace(slim, material=replace(beam.material, youngs_modulus=modulus * times**2))
    return replace(impact, beam=slim, sphere=replace(sphere, material=soft))
