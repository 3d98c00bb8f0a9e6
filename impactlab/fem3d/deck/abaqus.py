"""Abaqus/Explicit: the program of the paper's 3-D FE model.

Source of the syntax: Abaqus Keywords Guide, read in part (docs/decks.md). No deck has been run.
"""

from __future__ import annotations

from collections.abc import Iterator

from impactlab.fem3d.deck.case import STRESS, Case, Flavour, curve, gravity, values
from impactlab.fem3d.deck.mesh import BEAM_SURFACE, SPHERE_SURFACE, TRACKED, element_groups
from impactlab.model.impact import Material

_FRAMES = 50
"""States of all elements over the duration."""


def _hardening(material: Material) -> Iterator[str]:
    isotropic = material.isotropic_hardening_modulus
    kinematic = material.kinematic_hardening_modulus
    if kinematic == 0.0:
        yield "*PLASTIC"
        yield from curve(material, isotropic)
    elif isotropic == 0.0:
        yield "*PLASTIC, HARDENING=KINEMATIC"
        yield from curve(material, kinematic)
    else:
        yield "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=1"
        yield values(material.yield_stress * STRESS, kinematic * STRESS, 0.0)
        yield "*CYCLIC HARDENING"
        yield from curve(material, isotropic)


def _sections(case: Case) -> Iterator[str]:
    yield "*SECTION CONTROLS, NAME=HOURGLASS, HOURGLASS=ENHANCED"
    for name, (full, _) in element_groups(case.mesh).items():
        body = name.split("_")[0]
        controls = "" if full else ", CONTROLS=HOURGLASS"
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={body}_STEEL{controls}"


def _contact(_: Case) -> Iterator[str]:
    yield "*SURFACE INTERACTION, NAME=FRICTIONLESS"
    yield "*FRICTION"
    yield "0."
    yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD"


def _step(case: Case) -> Iterator[str]:
    yield "*STEP, NAME=IMPACT, NLGEOM=YES"
    yield "*DYNAMIC, EXPLICIT"
    yield f", {values(case.duration)}"
    yield from gravity(case)
    yield "*CONTACT PAIR, INTERACTION=FRICTIONLESS, MECHANICAL CONSTRAINT=KINEMATIC, CPSET=IMPACT"
    yield f"{SPHERE_SURFACE}, {BEAM_SURFACE}"
    yield f"*OUTPUT, HISTORY, TIME INTERVAL={values(case.time_between)}"
    yield f"*NODE OUTPUT, NSET={TRACKED}"
    yield "U3, V3, A3"
    yield "*CONTACT OUTPUT, CPSET=IMPACT"
    yield "CFN"
    yield "*ENERGY OUTPUT"
    yield "ALLIE, ALLKE, ALLPD, ALLAE, ALLVD, ALLWK, ETOTAL"
    yield f"*OUTPUT, FIELD, NUMBER INTERVAL={_FRAMES}"
    yield "*ELEMENT OUTPUT"
    yield "S, PEEQ"
    yield "*NODE OUTPUT"
    yield "U, V"
    yield "*END STEP"


ABAQUS = Flavour(
    program="Abaqus/Explicit",
    elements={True: "C3D8", False: "C3D8R"},
    hardening=_hardening,
    sections=_sections,
    contact=_contact,
    step=_step,
    limits=(
        "Never run: no Abaqus was at hand. Keywords are checked against its documented syntax as "
        "far as that could be read (docs/decks.md).",
        "Run it in double precision: contact begins at a gap of zero.",
    ),
)
