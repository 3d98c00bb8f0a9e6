"""The public function: an impact and its mesh become an input deck, in N, mm, t and s."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from impactlab.fem3d.deck.mesh import LENGTH, element_groups, geometry
from impactlab.fem3d.solver.mesh import Mesh
from impactlab.fem3d.solver.mesh.estimates import contact_radius
from impactlab.fem3d.solver.mesh.mesh import sphere_density
from impactlab.fem3d.solver.solve import IMPACT_PARAMETERS
from impactlab.model.checks import instance, one_of, positive
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, Material
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.verification.solutions import hertz

_STRESS = 1e-6
"""MPa per Pa."""
_OVERCLOSURE = 0.002
"""Overclosure at the contact's centre over the indentation, in Hertz's contact, in CalculiX."""
_LONGEST = 10.0
"""Plastic strain at which the tables end; both programs keep the stress from there on."""
_SAMPLES = 60
"""Intervals in the contact duration of an elastic half-space."""
_SAME = 1e-9
"""Relative difference of lengths that are the same."""


@dataclass(frozen=True, kw_only=True)
class Flavour:
    """One program. elements: its types, fully integrated (True) and not.

    kinematic: whether its kinematic hardening is right. limits: what a user has to know, a sentence
    each.
    """

    program: str
    elements: Mapping[bool, str]
    kinematic: bool
    limits: tuple[str, ...]


FLAVOURS = {
    "abaqus": Flavour(
        program="Abaqus/Explicit",
        elements={True: "C3D8", False: "C3D8R"},
        kinematic=True,
        limits=(
            "Never run: no Abaqus was at hand. Keywords are checked against its documented syntax "
            "as far as that could be read (docs/decks.md).",
            "Run it in double precision: contact begins at a gap of zero.",
        ),
    ),
    "calculix": Flavour(
        program="CalculiX 2.20",
        elements={True: "C3D8I", False: "C3D8I"},
        kinematic=False,
        limits=(
            "Small displacements, implicit dynamics with equal steps, contact by a linear penalty: "
            f"the overclosure at its centre is about {100.0 * _OVERCLOSURE:.9g} % of the "
            "indentation.",
            "CalculiX 2.20 crashes (segmentation fault in the first iteration) when *PLASTIC meets "
            "surface-to-surface contact in *DYNAMIC: for a run that finishes, take elastic "
            "materials (--elastic; write_deck with plastic=False).",
        ),
    ),
}
"""Programs that a deck can be written for; templates/NAME.inp.j2 is the text of each."""


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
    instance("deck", "impact", impact, Impact)
    instance("deck", "mesh", mesh, Mesh)
    positive("deck", "duration", duration)
    if interval is None:
        contact = hertz.contact_duration(*hertz.arguments(impact))
        interval = min(contact / _SAMPLES, duration)
    elif positive("deck", "interval", interval) > duration:
        raise ValueError(
            f"deck.interval = {interval!r} s: must not be above the duration ({duration!r} s)"
        )
    _check_mesh(mesh, impact)
    beam, ball = impact.beam.material, impact.sphere.material
    for material in (beam, ball):
        if plastic and material.kinematic_hardening_modulus > 0.0 and not chosen.kinematic:
            raise ValueError(
                f"deck: kinematic_hardening_modulus = {material.kinematic_hardening_modulus!r} Pa, "
                f"but {chosen.program} softens such a material where it should harden: write the "
                "deck for Abaqus, or with elastic materials"
            )
    # Hertz's largest pressure is 2 E* a/(pi R), his indentation a^2/R.
    modulus, radius = hertz.effective_modulus(impact), contact_radius(impact)
    given = flatten(impact, Discretisation())
    text = _TEMPLATES.get_template(f"{flavour}.inp.j2").render(
        flavour=chosen,
        version=version("impactlab"),
        impact=impact,
        mesh=mesh,
        duration=duration,
        interval=interval,
        plastic=plastic,
        given=[(PARAMETERS[name], given[name]) for name in IMPACT_PARAMETERS if name in given],
        geometry="\n".join(geometry(mesh, impact.sphere.radius, chosen.elements)),
        groups=element_groups(mesh),
        materials={
            "BEAM": (beam, beam.density),
            "SPHERE": (ball, sphere_density(mesh, impact)),
        },
        stiffness=2.0 * modulus / (math.pi * radius * _OVERCLOSURE),  # in Pa/m
    )
    path = Path(path)
    try:
        path.write_text(text, encoding="ascii", newline="\n")
    except OSError as error:
        raise ValueError(f"deck: cannot write {path}: {error.strerror}") from error
    return path


def _check_mesh(mesh: Mesh, impact: Impact) -> None:
    """Raise ValueError where the mesh is that of other bodies."""
    beam, nodes = impact.beam, mesh.nodes
    for name, meshed, wanted in (
        ("beam's span", 2.0 * nodes[mesh.support, 0].max(), beam.span),
        ("beam's width", 2.0 * nodes[mesh.support, 1].max(), beam.width),
        ("beam's depth", -nodes[:, 2].min(), beam.depth),
        ("sphere's radius", 0.5 * nodes[:, 2].max(), impact.sphere.radius),
    ):
        if not math.isclose(meshed, wanted, rel_tol=_SAME):
            raise ValueError(
                f"deck.mesh: the {name} is {meshed:.9g} m in the mesh and {wanted:.9g} m in the "
                "impact: make the mesh from this impact (quarter_mesh)"
            )


def _values(*entries: float) -> str:
    """Return one data line."""
    return ", ".join(f"{entry:.9g}" for entry in entries)


def _curve(material: Material, modulus: float) -> str:
    """Return yield stress against equivalent plastic strain, rising by `modulus` (Pa)."""
    lines = [_values(material.yield_stress * _STRESS, 0.0)]
    if modulus > 0.0:
        top = (material.yield_stress + modulus * _LONGEST) * _STRESS
        lines.append(_values(top, _LONGEST))
    return "\n".join(lines)


def _comment(text: str) -> str:
    """Return each line as a comment of lines that are not too long."""
    wrapper = textwrap.TextWrapper(96, initial_indent="** ", subsequent_indent="**   ")
    lines = (line for words in text.splitlines() for line in wrapper.wrap(words))
    return "".join(f"{line}\n" for line in lines)


_TEMPLATES = Environment(
    loader=PackageLoader("impactlab.fem3d.deck"),
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
    undefined=StrictUndefined,
)
_TEMPLATES.filters["comment"] = _comment
_TEMPLATES.globals |= {
    "values": _values,
    "curve": _curve,
    "STRESS": _STRESS,
    "LENGTH": LENGTH,
    "VELOCITY": 1e3,  # mm/s per m/s
    "ACCELERATION": 1e3,  # mm/s2 per m/s2
    "DENSITY": 1e-12,  # t/mm3 per kg/m3
}
