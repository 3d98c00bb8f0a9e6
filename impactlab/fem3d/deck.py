"""The public function: an impact and its mesh become an input deck, in N, mm, t and s."""

import math
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from impactlab.fem3d.solver.dataset import IMPACT_PARAMETERS
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.fem3d.solver.lattice import Integers
from impactlab.fem3d.solver.mesh import BEAM, FACES, SPHERE, Mesh, check_mesh, sphere_density
from impactlab.fem3d.solver.springs import Springs, springs_of
from impactlab.fem3d.solver.system import refuse_rate
from impactlab.model.bodies import Beam
from impactlab.model.checks import instance, one_of, positive
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.solver import RAYLEIGH
from impactlab.verification.solutions import hertz

LENGTH, _STRESS = 1e3, 1e-6  # mm per m, and MPa per Pa
_BODIES = {BEAM: "BEAM", SPHERE: "SPHERE"}

_PER_LINE = 16  # entries that a data line may hold in both programs
_OVERCLOSURE = 0.002  # at the centre, over the indentation, in Hertz's contact, in CalculiX
_FAR = 10.0  # length of springs that turn, over that of the mesh
_LONGEST = 10.0  # plastic strain at which the tables end; the stress remains from there on


@dataclass(frozen=True, kw_only=True)
class Flavour:
    """One program. elements: its types, fully integrated (True) and not. spring: its type.

    kinematic: whether its kinematic hardening is right. damps: whether it damps the beam alone.
    limits: what a user has to know, a sentence each.
    """

    program: str
    elements: Mapping[bool, str]
    spring: str
    kinematic: bool
    damps: bool
    limits: tuple[str, ...]


FLAVOURS = {
    "abaqus": Flavour(
        program="Abaqus/Explicit",
        elements={True: "C3D8", False: "C3D8R"},
        spring="SPRINGA",  # SPRING1 is of Abaqus/Standard alone
        kinematic=True,
        damps=True,
        limits=(
            "Never run: no Abaqus was at hand. Keywords are checked against its documented syntax "
            "as far as that could be read (docs/decks.md).",
            "Run it in double precision: contact begins at a gap of zero.",
        ),
    ),
    "calculix": Flavour(
        program="CalculiX 2.20",
        elements={True: "C3D8I", False: "C3D8I"},
        spring="SPRING1",
        kinematic=False,
        damps=False,
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
    """Write the input deck of `impact` on `mesh` (see impact_mesh), and return its path.

    flavour: a name in FLAVOURS. duration: simulated time in s. interval: time between results in
    s, which is CalculiX's step, too (None: a 60th of the contact duration of an elastic
    half-space). plastic: False leaves the materials elastic, without which CalculiX 2.20 does not
    get through a contact (docs/decks.md). The same arguments give the same text.

    Raises ValueError naming the argument that is not valid, the path that cannot be written, or
    what the program cannot do right: kinematic hardening and damping in CalculiX, damped springs.
    """
    chosen = FLAVOURS[one_of("deck", "flavour", flavour, tuple(FLAVOURS))]
    instance("deck", "impact", impact, Impact)
    instance("deck", "mesh", mesh, Mesh)
    positive("deck", "duration", duration)
    if interval is None:
        contact = hertz.contact_duration(*hertz.arguments(impact))
        interval = min(contact / 60.0, duration)
    elif positive("deck", "interval", interval) > duration:
        raise ValueError(
            f"deck.interval = {interval!r} s: must not be above the duration ({duration!r} s)"
        )
    check_mesh(mesh, impact)
    beam, ball = impact.beam.material, impact.sphere.material
    for material in (beam, ball):
        refuse_rate(material)
        if plastic and material.kinematic_hardening_modulus > 0.0 and not chosen.kinematic:
            raise ValueError(
                f"deck: kinematic_hardening_modulus = {material.kinematic_hardening_modulus!r} Pa, "
                f"but {chosen.program} softens such a material where it should harden: write the "
                "deck for Abaqus, or with elastic materials"
            )
    springs = springs_of(mesh, impact)
    _refuse_damping(impact.beam, chosen, springs)
    # Hertz's largest pressure is 2 E* a/(pi R), his indentation a^2/R.
    modulus, radius = hertz.effective_modulus(impact), contact_radius(impact)
    values = flatten(impact, Discretisation())
    groups = {
        f"{_BODIES[body]}_{'FINE' if full else 'COARSE'}": (full, numbers)
        for body, full, numbers in mesh.groups()
    }
    text = _TEMPLATES.get_template(f"{flavour}.inp.j2").render(
        flavour=chosen,
        version=version("impactlab"),
        impact=impact,
        mesh=mesh,
        duration=duration,
        interval=interval,
        plastic=plastic,
        given=[
            (PARAMETERS[name], values[name])
            for name in IMPACT_PARAMETERS
            if name in values and (values[name] != 0.0 or not _may_be_absent(name))
        ],
        geometry="\n".join(_geometry(mesh, groups, impact.sphere.radius, chosen)),
        springs="".join(f"{line}\n" for line in _springs(mesh, springs, chosen)),
        held=_held(mesh, grounded=chosen.spring == "SPRINGA" and springs.nodes.size > 0),
        groups=groups,
        materials={"BEAM": (beam, beam.density), "SPHERE": (ball, sphere_density(mesh, impact))},
        stiffness=2.0 * modulus / (math.pi * radius * _OVERCLOSURE),  # in Pa/m
    )
    path = Path(path)
    try:
        path.write_text(text, encoding="ascii", newline="\n")
    except OSError as error:
        raise ValueError(f"deck: cannot write {path}: {error.strerror}") from error
    return path


def _may_be_absent(name: str) -> bool:
    """Return whether zero of a parameter says that the beam does not have it."""
    return "stiffness" in name or "damping" in name


def _refuse_damping(beam: Beam, flavour: Flavour, springs: Springs) -> None:
    """Raise ValueError where a deck would damp something else than the beam and its springs."""
    names = [name for name in RAYLEIGH if getattr(beam, name) > 0.0]
    reason = ""
    if names and not flavour.damps:
        reason = f"{flavour.program} damps the sphere, too: set it to 0, or write it for Abaqus"
    elif "stiffness_damping" in names and springs.nodes.size:
        names = ["stiffness_damping"]
        reason = "springs of decks are not damped: set it to 0, or take the springs out"
    if reason:
        raise ValueError(f"deck: {names[0]} = {getattr(beam, names[0])!r}: {reason}")


def _outer(mesh: Mesh, body: int) -> tuple[Integers, Integers]:
    """Return the body's outer faces, (f, 2): element (from 0) and face (from 1); nodes, (f, 4)."""
    numbers = np.flatnonzero(mesh.body == body)
    nodes = mesh.elements[numbers][:, FACES].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(nodes, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer = np.sort(first[count == 1])
    faces = np.stack([numbers[outer // 6], outer % 6 + 1], axis=1)
    return faces, nodes[outer]


def _geometry(
    mesh: Mesh, groups: Mapping[str, tuple[bool, Integers]], radius: float, flavour: Flavour
) -> Iterator[str]:
    """Yield the mesh's lines, numbered from 1. radius: of the sphere in m."""
    yield "*NODE, NSET=ALL_NODES"
    for place, (x, y, z) in enumerate((LENGTH * mesh.nodes).tolist(), start=1):
        # 19 characters at most, of the 20 that CalculiX reads, with 13 digits.
        yield f"{place}, {x:.12e}, {y:.12e}, {z:.12e}"
    for name, (full, numbers) in groups.items():
        yield f"*ELEMENT, TYPE={flavour.elements[full]}, ELSET={name}"
        rows = np.column_stack([numbers, mesh.elements[numbers]]) + 1
        yield from (", ".join(map(str, row)) for row in rows.tolist())
    for body in _BODIES.values():
        yield f"*ELSET, ELSET={body}"
        yield from (name for name in groups if name.startswith(f"{body}_"))
    centre = np.linalg.norm(mesh.nodes - np.array([0.0, 0.0, radius]), axis=1).argmin()
    tracked = {
        "MIDSPAN": mesh.axis_node,
        "SPHERE_CENTRE": int(centre),
        "SPHERE_POLE": mesh.pole,
        "BEAM_TOP": mesh.top_node,
    }
    sets: dict[str, list[int]] = {
        "SPHERE_NODES": np.unique(mesh.elements[mesh.body == SPHERE]).tolist(),
        "SYMMETRY_X": mesh.symmetry_x.tolist(),
        "SYMMETRY_Y": mesh.symmetry_y.tolist(),
        "SUPPORT": mesh.support.tolist(),
        "CLAMPED": mesh.clamped.tolist(),
        **{name: [node] for name, node in tracked.items()},
        "TRACKED": list(tracked.values()),
    }
    for name, members in sets.items():
        if not members:
            continue
        yield f"*NSET, NSET={name}"
        for start in range(0, len(members), _PER_LINE):
            yield ", ".join(str(node + 1) for node in members[start : start + _PER_LINE])
    # The sphere's surface below its centre, and the beam's top.
    on_plane = np.abs(mesh.nodes) < 1e-6 * mesh.element_size  # through the origin, across an axis
    ball, corners = _outer(mesh, SPHERE)
    middle = mesh.nodes[corners, 2].mean(axis=1)
    height = 0.5 * np.ptp(mesh.nodes[np.unique(corners), 2])
    cut = np.any(on_plane[corners, :2].all(axis=1), axis=1)
    beam, above = _outer(mesh, BEAM)
    surfaces = {
        "SPHERE_SURFACE": ball[~cut & (middle < height)],
        "BEAM_SURFACE": beam[on_plane[above, 2].all(axis=1)],
    }
    for name, faces in surfaces.items():
        yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
        yield from (f"{element + 1}, S{face}" for element, face in faces.tolist())


def _springs(mesh: Mesh, springs: Springs, flavour: Flavour) -> Iterator[str]:
    """Yield the lines of springs, numbered on from the mesh, in sets of one axis and stiffness.

    SPRINGA turns with the line between its nodes: the other one is so far away, outwards from the
    beam along the axis, that it does not.
    """
    places = LENGTH * mesh.nodes[springs.nodes]
    far = _FAR * np.ptp(LENGTH * mesh.nodes[:, 0])
    outwards = np.where(springs.axes == 0, np.sign(places[:, 0]), -1.0)
    places[np.arange(len(places)), springs.axes] += far * outwards
    alone = flavour.spring == "SPRING1"
    if len(places) and not alone:
        yield "*NODE, NSET=GROUND"
        for number, (x, y, z) in enumerate(places.tolist(), len(mesh.nodes) + 1):
            yield f"{number}, {x:.12e}, {y:.12e}, {z:.12e}"
    sets: dict[tuple[int, str], list[int]] = {}
    # A point in the number tells CalculiX that it is no axis.
    stiffness = [f"{value:.9e}" for value in (springs.stiffness / LENGTH).tolist()]
    for row, key in enumerate(zip(springs.axes.tolist(), stiffness, strict=True)):
        sets.setdefault(key, []).append(row)
    for count, ((axis, value), rows) in enumerate(sets.items(), start=1):
        yield f"*ELEMENT, TYPE={flavour.spring}, ELSET=SPRINGS_{count}"
        for row in rows:
            ground = [] if alone else [len(mesh.nodes) + 1 + row]
            numbers = [len(mesh.elements) + 1 + row, *ground, int(springs.nodes[row]) + 1]
            yield ", ".join(map(str, numbers))
        yield f"*SPRING, ELSET=SPRINGS_{count}"
        yield str(axis + 1) if alone else ""
        yield value


def _held(mesh: Mesh, *, grounded: bool) -> str:
    """Return the sets of nodes that are held, in their directions, one data line each."""
    sets = {
        "SYMMETRY_X, 1, 1": mesh.symmetry_x,
        "SYMMETRY_Y, 2, 2": mesh.symmetry_y,
        "SUPPORT, 3, 3": mesh.support,
        "CLAMPED, 1, 3": mesh.clamped,
    }
    lines = [line for line, nodes in sets.items() if nodes.size]
    return "\n".join(lines + ["GROUND, 1, 3"] * grounded)


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
    lines = (line for paragraph in text.splitlines() for line in wrapper.wrap(paragraph))
    return "".join(f"{line}\n" for line in lines)


_TEMPLATES = Environment(
    loader=PackageLoader("impactlab.fem3d"),
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
    "ends": {
        "pinned": "held at mid-depth",
        "clamped": "held all over its face",
        "free": "free",
        "elastic": "on springs",
    },
    "ACCELERATION": 1e3,  # mm/s2 per m/s2
    "DENSITY": 1e-12,  # t/mm3 per kg/m3
}
