"""The comment at a deck's top: what it is, of what case, in which units, and its limits."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from importlib.metadata import version

from impactlab.fem3d.deck.case import Case
from impactlab.fem3d.deck.flavour import Flavour
from impactlab.fem3d.deck.units import NAMES
from impactlab.model.discretisation import Discretisation
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
    """Lines of comment."""
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
