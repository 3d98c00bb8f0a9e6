"""CalculiX: implicit dynamics with penalty contact from surface to surface.

Source of the syntax: G. Dhondt, CalculiX CrunchiX User's Manual, version 2.20.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from impactlab.fem3d.deck.case import LENGTH, STRESS, Case, Flavour, curve, gravity, values
from impactlab.fem3d.deck.mesh import BEAM_SURFACE, BODIES, SPHERE_SURFACE, TRACKED
from impactlab.fem3d.solver.mesh.estimates import contact_radius
from impactlab.model.impact import Material
from impactlab.verification.solutions import hertz

_OVERCLOSURE = 0.002
"""Overclosure at the contact's centre over the indentation, in Hertz's contact."""
_INCREMENTS = 1_000_000
"""More than any run needs: CalculiX stops with an error at 100 otherwise."""


def _hardening(material: Material) -> Iterator[str]:
    if material.kinematic_hardening_modulus > 0.0:
        raise ValueError(
            f"deck: kinematic_hardening_modulus = {material.kinematic_hardening_modulus!r} Pa, but "
            "CalculiX 2.20 softens such a material where it should harden: write the deck for "
            "Abaqus, or with elastic materials"
        )
    yield "*PLASTIC"
    yield from curve(material, material.isotropic_hardening_modulus)


def _sections(_: Case) -> Iterator[str]:
    for body in BODIES:
        yield f"*SOLID SECTION, ELSET={body}, MATERIAL={body}_STEEL"


def _contact(case: Case) -> Iterator[str]:
    yield "*SURFACE INTERACTION, NAME=FRICTIONLESS"
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    # Hertz's largest pressure is 2 E* a/(pi R), his indentation a^2/R.
    modulus, radius = hertz.effective_modulus(case.impact), contact_radius(case.impact)
    slope = 2.0 * modulus / (math.pi * radius * _OVERCLOSURE)  # over overclosure, in Pa/m
    yield values(slope * STRESS / LENGTH)
    yield "*CONTACT PAIR, INTERACTION=FRICTIONLESS, TYPE=SURFACE TO SURFACE"
    yield f"{SPHERE_SURFACE}, {BEAM_SURFACE}"


def _step(case: Case) -> Iterator[str]:
    yield f"*STEP, INC={_INCREMENTS}"
    yield "*DYNAMIC, DIRECT"
    yield values(case.time_between, case.duration)
    yield from gravity(case)
    yield f"*NODE PRINT, NSET={TRACKED}"
    yield "U, V"
    yield f"*CONTACT PRINT, SLAVE={SPHERE_SURFACE}, MASTER={BEAM_SURFACE}"
    yield "CF"
    yield "*NODE FILE"
    yield "U"
    yield "*EL FILE"
    yield "S, PEEQ" if case.plastic else "S"
    yield "*END STEP"


CALCULIX = Flavour(
    program="CalculiX 2.20",
    elements={True: "C3D8I", False: "C3D8I"},
    hardening=_hardening,
    sections=_sections,
    contact=_contact,
    step=_step,
    limits=(
        "Small displacements, implicit dynamics with equal steps, contact by a linear penalty: the "
        f"overclosure at its centre is about {100.0 * _OVERCLOSURE:.9g} % of the indentation.",
        "CalculiX 2.20 crashes (segmentation fault in the first iteration) when *PLASTIC meets "
        "surface-to-surface contact in *DYNAMIC: for a run that finishes, take elastic materials "
        "(--elastic; write_deck with plastic=False).",
    ),
)
