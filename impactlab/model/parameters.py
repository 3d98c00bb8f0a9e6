"""The flat table of everything that a run can vary: names, units, and where each one lives.

The names serve as keys of study files, coordinates of datasets and fields of the kernels' case
table alike, so that a parameter is spelled in one way everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from impactlab.model.checks import Column
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import MODELS, Impact
from impactlab.solver import RULES, SCHEMES
from impactlab.solver.contact import LAWS

Value = float | int | str


@dataclass(frozen=True)
class Parameter:
    """One entry: `path` leads from (impact, discretisation) to the field.

    units: UDUNITS spelling, "1" for a pure number. choices: the allowed words, for parameters
    that are names; `whole`: for those that count.
    """

    name: str
    units: str
    long_name: str
    path: tuple[str, ...]
    choices: tuple[str, ...] = ()
    whole: bool = False


def _material(body: str) -> tuple[Parameter, ...]:
    def entry(field: str, units: str, words: str) -> Parameter:
        path = ("impact", body, "material", field)
        return Parameter(f"{body}_{field}", units, f"{words} of the {body}", path)

    return (
        entry("density", "kg m-3", "density"),
        entry("youngs_modulus", "Pa", "Young's modulus"),
        entry("poissons_ratio", "1", "Poisson's ratio"),
        entry("yield_stress", "Pa", "yield stress"),
        entry("isotropic_hardening_modulus", "Pa", "isotropic hardening modulus"),
        entry("kinematic_hardening_modulus", "Pa", "kinematic hardening modulus"),
    )


PARAMETERS: dict[str, Parameter] = {
    entry.name: entry
    for entry in (
        Parameter("velocity", "m s-1", "impact velocity", ("impact", "velocity")),
        Parameter("gravity", "m s-2", "gravity on the sphere", ("impact", "gravity")),
        Parameter("contact", "1", "contact law", ("impact", "contact"), choices=LAWS),
        Parameter("beam_model", "1", "model of the beam", ("impact", "beam_model"), choices=MODELS),
        Parameter("sphere_radius", "m", "radius of the sphere", ("impact", "sphere", "radius")),
        Parameter("sphere_mass", "kg", "mass of the sphere", ("impact", "sphere", "mass")),
        *_material("sphere")[:4],
        Parameter("beam_span", "m", "span of the beam", ("impact", "beam", "span")),
        Parameter("beam_width", "m", "width of the beam", ("impact", "beam", "width")),
        Parameter("beam_depth", "m", "depth of the beam", ("impact", "beam", "depth")),
        Parameter(
            "shear_coefficient",
            "1",
            "shear coefficient of the beam",
            ("impact", "beam", "shear_coefficient"),
        ),
        *_material("beam"),
        Parameter("nodes", "1", "nodes along the span", ("discretisation", "nodes"), whole=True),
        Parameter(
            "points",
            "1",
            "integration points over the depth",
            ("discretisation", "points"),
            whole=True,
        ),
        Parameter("rule", "1", "integration rule", ("discretisation", "rule"), choices=RULES),
        Parameter("scheme", "1", "scheme in time", ("discretisation", "scheme"), choices=SCHEMES),
        Parameter(
            "courant",
            "1",
            "time step over the scheme's largest",
            ("discretisation", "courant"),
        ),
        Parameter(
            "element_size",
            "m",
            "size of the solid elements about the contact",
            ("discretisation", "element_size"),
        ),
        Parameter(
            "elements_per_radius",
            "1",
            "solid elements over the expected contact radius",
            ("discretisation", "elements_per_radius"),
        ),
    )
}
ELEMENTS = ("element_size", "elements_per_radius")
"""The parameters of the 3-D model's elements, which takes one of them."""


def flatten(impact: Impact, discretisation: Discretisation) -> dict[str, Value]:
    """Return every parameter's value by name, without those that are None (mass, element size)."""
    roots = {"impact": impact, "discretisation": discretisation}
    values = {name: _get(roots, entry.path) for name, entry in PARAMETERS.items()}
    return {name: value for name, value in values.items() if value is not None}


def with_values(
    impact: Impact, discretisation: Discretisation, values: Mapping[str, Value | Column]
) -> tuple[Impact, Discretisation]:
    """Return the base with the named parameters replaced, checked anew; a column is many runs.

    Raises ValueError for an unknown name, or where the model classes refuse a value.
    """
    roots: dict[str, Any] = {"impact": impact, "discretisation": discretisation}
    tree: dict[str, Any] = {}
    for name, value in values.items():
        if name not in PARAMETERS:
            raise ValueError(f"unknown parameter {name!r}: choose from {', '.join(PARAMETERS)}")
        node = tree
        *parents, leaf = PARAMETERS[name].path
        for part in parents:
            node = node.setdefault(part, {})
        node[leaf] = value
    changed = {key: _replaced(root, tree.get(key, {})) for key, root in roots.items()}
    return changed["impact"], changed["discretisation"]


def _get(roots: Mapping[str, Any], path: tuple[str, ...]) -> Any:
    node: Any = roots[path[0]]
    for part in path[1:]:
        node = getattr(node, part)
    return node


def _replaced(node: Any, changes: Mapping[str, Any]) -> Any:
    """Return `node` with nested changes, its checks run on all of them at once."""
    fields = {
        key: _replaced(getattr(node, key), change) if isinstance(change, dict) else change
        for key, change in changes.items()
    }
    return replace(node, **fields) if fields else node
