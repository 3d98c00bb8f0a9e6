"""Cards that both programs share: the comment at the top, materials, supports and loads."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from importlib.metadata import version

from impactlab.fem3d.deck.case import (
    ACCELERATION,
    DENSITY,
    NAMES,
    STRESS,
    VELOCITY,
    Case,
    Flavour,
    Hardening,
    values,
)
from impactlab.fem3d.deck.mesh import SPHERE_NODES, SUPPORT, SYMMETRY_X, SYMMETRY_Y
from impactlab.fem3d.solver.mesh import SPHERE
from impactlab.fem3d.solver.mesh.mesh import element_volumes
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Material
from impactlab.model.parameters import PARAMETERS, flatten

_WIDTH = 96
_ONLY_OF_BEAM_MODELS = ("contact", "beam_model", "shear_coefficient")

_LIMITS = (
    "A quarter: x = 0 and y = 0 are planes of symmetry, z points upwards; contact forces are a "
    "quarter of the whole.",
    "Frictionless; the sphere touches the beam's top at the origin when time begins; gravity acts "
    "on the sphere alone; the beam's ends are held at mid-depth.",
)


def header(case: Case, flavour: Flavour) -> Iterator[str]:
    """Yield the lines of the comment."""
    mesh = case.mesh
    yield from _said(
        f"impactlab {version('impactlab')}: a sphere strikes a beam, for {flavour.program}"
    )
    yield from _said(f"Units: {NAMES}")
    yield from _said(
        f"Mesh: {len(mesh.nodes)} nodes, {len(mesh.elements)} elements, "
        f"{mesh.element_size * 1e3:.9g} mm in the contact"
    )
    yield from _said(f"Materials: {'elastic-plastic' if case.plastic else 'elastic'}")
    yield from _said("Case, in SI units:")
    values = flatten(case.impact, Discretisation())
    for name, value in values.items():
        entry = PARAMETERS[name]
        if entry.path[0] == "impact" and name not in _ONLY_OF_BEAM_MODELS:
            units = "" if entry.units == "1" else f" {entry.units}"
            yield from _said(f"  {entry.long_name}: {value!r}{units}")
    yield from _said("Limits:")
    for limit in (*_LIMITS, *flavour.limits):
        yield from _said(f"- {limit}")


def _said(words: str) -> Iterator[str]:
    yield from textwrap.wrap(
        words, _WIDTH, initial_indent="** ", subsequent_indent="**   ", drop_whitespace=True
    )


_LONGEST = 10.0
"""Plastic strain at which the tables end; both programs keep the stress from there on."""


def materials(case: Case, hardening: Hardening) -> Iterator[str]:
    """Yield both bodies' materials. hardening: the program's cards for plasticity, in MPa."""
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
    """Return the density in kg/m3 that gives the meshed sphere the mass of the impact."""
    quarter = element_volumes(case.mesh)[case.mesh.body == SPHERE].sum()
    return float(case.impact.sphere.total_mass / 4.0 / quarter)


def curve(material: Material, modulus: float) -> Iterator[str]:
    """Yield stress against equivalent plastic strain, rising by `modulus` (Pa): one point if 0."""
    yield values(material.yield_stress * STRESS, 0.0)
    if modulus > 0.0:
        yield values((material.yield_stress + modulus * _LONGEST) * STRESS, _LONGEST)


def supports() -> Iterator[str]:
    """Yield the planes of symmetry, and the supports of the beam's ends at mid-depth."""
    yield "*BOUNDARY"
    yield f"{SYMMETRY_X}, 1, 1"
    yield f"{SYMMETRY_Y}, 2, 2"
    yield f"{SUPPORT}, 3, 3"


def start(case: Case) -> Iterator[str]:
    """Yield the downward velocity of the sphere at first touch."""
    yield "*INITIAL CONDITIONS, TYPE=VELOCITY"
    yield f"{SPHERE_NODES}, 3, {values(-case.impact.velocity * VELOCITY)}"


def gravity(case: Case) -> Iterator[str]:
    """Yield gravity on the sphere alone, as in the beam models."""
    if case.impact.gravity > 0.0:
        yield "*DLOAD"
        yield f"SPHERE, GRAV, {values(case.impact.gravity * ACCELERATION, 0.0, 0.0, -1.0)}"
