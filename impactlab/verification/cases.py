"""Impacts that more than one check uses, and the solver's grid for them."""

from dataclasses import dataclass, replace
from typing import Any

from impactlab.model.bodies import Beam, Sphere
from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.material import Material
from impactlab.solve import fibre_section
from impactlab.solver.beam import BeamGrid
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import discretise


@dataclass(frozen=True)
class Sweep:
    """An impact at several velocities (m/s), each over `duration` (s)."""

    impact: Impact
    velocities: tuple[float, ...]
    duration: float


def with_beam_material(impact: Impact, **changes: Any) -> Impact:
    """Return `impact` on a beam of another material, its fields as in Material."""
    material = replace(impact.beam.material, **changes)
    return replace(impact, beam=replace(impact.beam, material=material))


def elastic(impact: Impact) -> Impact:
    """Return `impact` on a beam that never yields, under Hertz contact.

    The yield stress is raised to a tenth of Young's modulus: a strain of 0.1 is out of reach.
    """
    beyond = 0.1 * impact.beam.material.youngs_modulus
    return replace(with_beam_material(impact, yield_stress=beyond), contact="hertz")


def rigid_backed(velocity: float, contact: str) -> Impact:
    """Return the paper's sphere on a beam of enormous mass and its own stiffness, without gravity.

    E* is the paper's. The law of the finite elements is written anew for bodies of one modulus.
    """
    impact = paper_impact(velocity, contact)
    metals = impact.sphere.material, impact.beam.material
    stiffness = 2.0 / sum(1.0 / metal.youngs_modulus for metal in metals)
    metal = replace(metals[0], youngs_modulus=stiffness)
    impact = replace(impact, sphere=replace(impact.sphere, material=metal))
    return replace(with_beam_material(impact, density=7.8e9, youngs_modulus=stiffness), gravity=0.0)


def aluminium_impact() -> Impact:
    """Return a steel sphere on a slender beam of aluminium, 400 x 30 x 12 mm."""
    alloy = Material(density=2700.0, youngs_modulus=70e9, poissons_ratio=0.33, yield_stress=250e6)
    return Impact(
        sphere=Sphere(radius=0.015, material=paper_impact().sphere.material),
        beam=Beam(span=0.4, width=0.03, depth=0.012, material=alloy),
        velocity=1.0,
        contact="stronge",
    )


def slimmer(impact: Impact, times: float) -> Impact:
    """Return an impact of the same bending and contact, with depth/span `times` smaller.

    rho A, EI and E* stay: Young's modulus grows with the square of `times`, width makes up for
    depth, and the sphere yields what the beam's surface no longer does. To Euler and Bernoulli all
    of these are one beam; rho I/(rho A) and EI/(k G A), of rotary inertia and shear, go with
    (depth/span)^2.
    """
    beam, sphere = impact.beam, impact.sphere
    modulus, softer = beam.material.youngs_modulus, sphere.material
    share = (1.0 - beam.material.poissons_ratio**2) / modulus
    lost = share * (1.0 - 1.0 / times**2)
    factor = 1.0 - softer.poissons_ratio**2
    soft = replace(softer, youngs_modulus=factor / (factor / softer.youngs_modulus + lost))
    slim = replace(beam, depth=beam.depth / times, width=beam.width * times)
    slim = replace(slim, material=replace(beam.material, youngs_modulus=modulus * times**2))
    return replace(impact, beam=slim, sphere=replace(sphere, material=soft))


def timoshenko_impact() -> Impact:
    """Return a 10 mm-radius steel sphere at 10 mm/s on a 10 x 10 x 153.5 mm steel beam.

    S. Timoshenko, Zur Frage nach der Wirkung eines Stosses auf einen Balken, Z. Math. Phys. 62
    (1913) 198: E = 2.2e6 kgf/cm2, density 7.96 g/cm3, nu = 0.3, quoted at second hand. Without
    gravity, which would matter: during the contact it adds 15 % of the velocity. The yield stress
    is ours; it plays no part in an elastic impact.
    """
    modulus = 2.2e6 * 98066.5  # Pa in a kgf/cm2
    steel = Material(density=7960.0, youngs_modulus=modulus, poissons_ratio=0.3, yield_stress=1e9)
    return Impact(
        sphere=Sphere(radius=0.01, material=steel),
        beam=Beam(span=0.1535, width=0.01, depth=0.01, material=steel),
        velocity=0.01,
        contact="hertz",
        gravity=0.0,
    )


def discretised(impact: Impact, grid: Discretisation, duration: float) -> tuple[BeamGrid, int]:
    """Return the solver's grid, and its number of time steps in `duration` (s)."""
    case = case_table(impact, grid, duration=duration)[0]
    cut, steps = discretise(case, make_pair(case), fibre_section(case))
    return cut, int(steps)
