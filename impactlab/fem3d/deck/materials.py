"""Elasticity, density and J2 plasticity with linear hardening in a deck."""

from __future__ import annotations

from collections.abc import Iterator

from impactlab.fem3d.deck.case import Case
from impactlab.fem3d.deck.flavour import Hardening
from impactlab.fem3d.deck.lines import values
from impactlab.fem3d.deck.units import DENSITY, STRESS
from impactlab.fem3d.solver.mesh import SPHERE
from impactlab.fem3d.solver.stepping.masses import element_volumes
from impactlab.model.material import Material

_LONGEST = 10.0
"""Plastic strain at which the tables end; both programs keep the stress from there on."""


def materials(case: Case, hardening: Hardening) -> Iterator[str]:
    """Both bodies' materials. hardening: the program's cards for plasticity, in MPa."""
    for name, material, density in (
        ("BEAM", case.impact.beam.material, case.impact.beam.material.density),
        ("SPHERE", case.impact.sphere.material, _sphere_density(case)),
    ):
        yield f"*MATERIAL, NAME={name}_STEEL"
        yield "*DENSITY"
        yield values(density * DENSITY)
        yield "*ELASTIC"
        yield values(material.youngs_modulus * STRESS, material.poissons_ratio)
        if case.plastic:
            yield from hardening(material)


def _sphere_density(case: Case) -> float:
    """In kg/m3: that which gives the sphere of the mesh the mass of the impact."""
    quarter = element_volumes(case.mesh)[case.mesh.body == SPHERE].sum()
    return float(case.impact.sphere.total_mass / 4.0 / quarter)


def curve(material: Material, modulus: float) -> Iterator[str]:
    """Stress against equivalent plastic strain that rises by `modulus` (Pa): one point if by 0."""
    yield values(material.yield_stress * STRESS, 0.0)
    if modulus > 0.0:
        yield values((material.yield_stress + modulus * _LONGEST) * STRESS, _LONGEST)
