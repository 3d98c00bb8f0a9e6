"""The public function: an impact and its mesh become an input deck."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from impactlab.fem3d.deck.abaqus import ABAQUS
from impactlab.fem3d.deck.calculix import CALCULIX
from impactlab.fem3d.deck.cards import header, materials, start, supports
from impactlab.fem3d.deck.case import Case, Flavour
from impactlab.fem3d.deck.mesh import geometry
from impactlab.fem3d.solver.mesh import Mesh
from impactlab.model.checks import one_of
from impactlab.model.impact import Impact

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
    yield from header(case, flavour)
    yield from geometry(case, flavour.elements)
    yield from materials(case, flavour.hardening)
    yield from flavour.sections(case)
    yield from supports()
    yield from start(case)
    yield from flavour.contact(case)
    yield from flavour.step(case)
