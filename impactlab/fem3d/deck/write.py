"""The public function: an impact and its mesh become an input deck."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from impactlab.fem3d.deck.abaqus import ABAQUS
from impactlab.fem3d.deck.calculix import CALCULIX
from impactlab.fem3d.deck.case import DENSITY, NAMES, STRESS, VELOCITY, Case, Flavour, values
from impactlab.fem3d.deck.mesh import SPHERE_NODES, SUPPORT, SYMMETRY_X, SYMMETRY_Y, geometry
from impactlab.fem3d.solver.mesh import Mesh
from impactlab.fem3d.solver.mesh.mesh import sphere_density
from impactlab.fem3d.solver.solve import IMPACT_PARAMETERS
from impactlab.model.checks import one_of
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.parameters import PARAMETERS, flatten

FLAVOURS = {"abaqus": ABAQUS, "calculix": CALCULIX}
"""Programs that a deck can be written for."""


def write_deck(
    path: Path | str,
    impact: Impact,
    mesh: Mesh,
    *,
    flavour: str,
    duration: float,
    interval: float | None = None,
    plastic: bool = True,
) -> Path:
    """Write the input deck of `impact` on `mesh` (see quarter_mesh), and return its path.

    flavour: a name in FLAVOURS. duration: simulated time in s. interval: time between results in
    s, which is CalculiX's step, too (None: a 60th of the contact duration of an elastic
    half-space). plastic: False leaves the materials elastic, without which CalculiX 2.20 does not
    get through a contact (docs/decks.md). The same arguments give the same text.

    Raises ValueError naming the argument that is not valid, the path that cannot be written, or
    what the program cannot do right: kinematic hardening in CalculiX.
    """
    chosen = FLAVOURS[one_of("deck", "flavour", flavour, tuple(FLAVOURS))]
    case = Case(impact=impact, mesh=mesh, duration=duration, interval=interval, plastic=plastic)
    text = "".join(f"{line}\n" for line in _lines(case, chosen))
    path = Path(path)
    try:
        path.write_text(text, encoding="ascii", newline="\n")
    except OSError as error:
        raise ValueError(f"deck: cannot write {path}: {error.strerror}") from error
    return path


def _lines(case: Case, flavour: Flavour) -> Iterator[str]:
    yield "*HEADING"
    yield f"impactlab: a sphere strikes a beam ({flavour.program})"
    for words in _comment(case, flavour):
        yield from textwrap.wrap(
            words, _WIDTH, initial_indent="** ", subsequent_indent="**   ", drop_whitespace=True
        )
    yield from geometry(case, flavour.elements)
    beam, ball = case.impact.beam.material, case.impact.sphere.material
    for name, material, density in (
        ("BEAM", beam, beam.density),
        ("SPHERE", ball, sphere_density(case.mesh, case.impact)),
    ):
        yield f"*MATERIAL, NAME={name}_STEEL"
        yield "*DENSITY"
        yield values(density * DENSITY)
        yield "*ELASTIC"
        yield values(material.youngs_modulus * STRESS, material.poissons_ratio)
        if case.plastic:
            yield from flavour.hardening(material)
    yield from flavour.sections(case)
    yield "*BOUNDARY"
    yield f"{SYMMETRY_X}, 1, 1"
    yield f"{SYMMETRY_Y}, 2, 2"
    yield f"{SUPPORT}, 3, 3"
    yield "*INITIAL CONDITIONS, TYPE=VELOCITY"
    yield f"{SPHERE_NODES}, 3, {values(-case.impact.velocity * VELOCITY)}"
    yield from flavour.contact(case)
    yield from flavour.step(case)


_WIDTH = 96

_LIMITS = (
    "A quarter: x = 0 and y = 0 are planes of symmetry, z points upwards; contact forces are a "
    "quarter of the whole.",
    "Frictionless; the sphere touches the beam's top at the origin when time begins; gravity acts "
    "on the sphere alone; the beam's ends are held at mid-depth.",
)


def _comment(case: Case, flavour: Flavour) -> Iterator[str]:
    """Yield the paragraphs of the comment at the top."""
    mesh = case.mesh
    yield f"impactlab {version('impactlab')}: a sphere strikes a beam, for {flavour.program}"
    yield f"Units: {NAMES}"
    yield (
        f"Mesh: {len(mesh.nodes)} nodes, {len(mesh.elements)} elements, "
        f"{mesh.element_size * 1e3:.9g} mm in the contact"
    )
    yield f"Materials: {'elastic-plastic' if case.plastic else 'elastic'}"
    yield "Case, in SI units:"
    given = flatten(case.impact, Discretisation())
    for name in IMPACT_PARAMETERS:
        if name in given:
            entry = PARAMETERS[name]
            units = "" if entry.units == "1" else f" {entry.units}"
            yield f"  {entry.long_name}: {given[name]!r}{units}"
    yield "Limits:"
    yield from (f"- {limit}" for limit in (*_LIMITS, *flavour.limits))
