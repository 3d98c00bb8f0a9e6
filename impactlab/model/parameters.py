"""The flat table of everything that a run can vary: names, units, and where each one lives.

The names serve as keys of study files, coordinates of datasets and fields of the kernels' case
table alike, so that a parameter is spelled in one way everywhere.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from impactlab import wings
from impactlab.model.checks import Column, did_you_mean
from impactlab.model.contact_law import LAW_NAMES
from impactlab.model.discretisation import Discretisation
from impactlab.model.flow_law import FLOW_LAW_NAMES
from impactlab.model.impact import MODELS, Impact
from impactlab.model.section import THICKNESSES
from impactlab.solver import COMPLIANCES, LOADS, PRESTRESSES, RULES, SCHEMES, SHAPES, SUPPORTS

Value = float | int | str


@dataclass(frozen=True)
class Parameter:
    """One entry: `path` leads from (impact, discretisation) to the field.

    units: UDUNITS spelling, "1" for a pure number. choices: the allowed words, for parameters
    that are names; is_integer: for those that count; any_word: for those that may be words of any
    kind, as the arguments of a Python function.
    """

    name: str
    units: str
    long_name: str
    path: tuple[str, ...]
    choices: Sequence[str] = ()
    is_integer: bool = False
    any_word: bool = False


_SIZES = wings.sizes().values()
_MATERIAL = (
    ("density", "kg m-3", "density"),
    ("youngs_modulus", "Pa", "Young's modulus"),
    ("poissons_ratio", "1", "Poisson's ratio"),
    ("yield_stress", "Pa", "yield stress"),
    ("isotropic_hardening_modulus", "Pa", "isotropic hardening modulus"),
    ("kinematic_hardening_modulus", "Pa", "kinematic hardening modulus"),
    ("rate_coefficient", "s-1", "Cowper-Symonds coefficient"),
    ("rate_exponent", "1", "Cowper-Symonds exponent"),
    ("rate_sensitivity", "1", "Johnson-Cook rate coefficient"),
    ("reference_rate", "s-1", "Johnson-Cook reference strain rate"),
    ("flow_law", "1", "flow law"),
)
_SPRINGS = (
    ("", "N m-1", "stiffness"),
    ("rotational_", "N m", "rotational stiffness"),
)
_ROWS = (
    ("velocity", "m s-1", "impact velocity", "impact.velocity"),
    ("gravity", "m s-2", "gravity on the sphere", "impact.gravity"),
    ("contact", "1", "contact law", "impact.contact"),
    ("beam_model", "1", "model of the beam", "impact.beam_model"),
    ("load", "1", "place of the contact force on the beam", "impact.load"),
    ("contact_compliance", "1", "bodies of the local compliance", "impact.contact_compliance"),
    ("contact_prestress", "1", "stress beneath the contact", "impact.contact_prestress"),
    ("sphere_radius", "m", "radius of the sphere", "impact.sphere.radius"),
    ("sphere_mass", "kg", "mass of the sphere", "impact.sphere.mass"),
    *(
        (f"sphere_{field}", units, f"{text} of the sphere", f"impact.sphere.material.{field}")
        for field, units, text in _MATERIAL[:4]  # a sphere does not harden, nor by rate
    ),
    ("strike_position", "1", "place of the strike over the span", "impact.strike_position"),
    ("strikes", "1", "number of strikes on that place", "impact.strikes"),
    ("strike_interval", "s", "time between strikes", "impact.strike_interval"),
    ("further_spheres", "1", "further spheres", "impact.further_spheres"),
    ("support_left", "1", "left support of the beam", "impact.beam.support_left"),
    ("support_right", "1", "right support of the beam", "impact.beam.support_right"),
    *(
        (
            f"{kind}stiffness_{side}",
            units,
            f"{text} of the {side} support",
            f"impact.beam.{kind}stiffness_{side}",
        )
        for kind, units, text in _SPRINGS
        for side in ("left", "right")
    ),
    *(
        (field, units, text, f"impact.beam.{field}")
        for field, units, text in (
            ("mass_damping", "s-1", "damping over mass, of the beam"),
            ("stiffness_damping", "s", "damping over bending stiffness, of the beam"),
            ("damping_ratio", "1", "damping ratio of the beam's modes"),
            ("foundation_stiffness", "N m-2", "stiffness of the beam's foundation"),
        )
    ),
    ("beam_span", "m", "span of the beam", "impact.beam.span"),
    ("beam_width", "m", "width of the beam", "impact.beam.width"),
    ("beam_depth", "m", "depth of the beam", "impact.beam.depth"),
    ("beam_shape", "1", "shape of the section", "impact.beam.shape"),
    *(
        (f"beam_{part}_thickness", "m", text, f"impact.beam.{part}_thickness")
        for part, text in (
            ("wall", "wall thickness of the beam"),
            ("flange", "flange thickness of the beam"),
            ("web", "web thickness of the beam"),
        )
    ),
    ("beam_profile", "1", "width over the depth", "impact.beam.profile"),
    ("beam_layers", "1", "layers from the axis outwards", "impact.beam.layers"),
    ("shear_coefficient", "1", "shear coefficient of the beam", "impact.beam.shear_coefficient"),
    *(
        (f"beam_{field}", units, f"{text} of the beam", f"impact.beam.material.{field}")
        for field, units, text in _MATERIAL
    ),
    ("nodes", "1", "nodes along the span", "discretisation.nodes"),
    ("points", "1", "integration points over the depth", "discretisation.points"),
    ("rule", "1", "integration rule", "discretisation.rule"),
    ("scheme", "1", "scheme in time", "discretisation.scheme"),
    ("courant", "1", "time step over the scheme's largest", "discretisation.courant"),
    *((size.name, size.units, size.long_name, f"discretisation.{size.name}") for size in _SIZES),
)
LAW_PARAMETERS = {"contact": LAW_NAMES, "beam_flow_law": FLOW_LAW_NAMES}
"""Parameters whose words are names of laws, to which users may add their own."""
_CHOICES = {
    **LAW_PARAMETERS,
    "beam_model": MODELS,
    "load": LOADS,
    "contact_compliance": COMPLIANCES,
    "contact_prestress": PRESTRESSES,
    "support_left": SUPPORTS,
    "support_right": SUPPORTS,
    "beam_shape": SHAPES,
    "rule": RULES,
    "scheme": SCHEMES,
}
_WHOLE = ("strikes", "nodes", "points")
WORDS = ("beam_profile", "beam_layers", "further_spheres")
"""Parameters that are lists of numbers, as text."""
SECTION = ("beam_shape", *WORDS[:2], *(f"beam_{field}" for field in THICKNESSES))
"""Parameters of the section beside width and depth."""
PROFILE_FIXED = "is the same in all runs: vary beam_width and beam_depth, which scale it"
SPHERES_FIXED = "is the same in all runs: vary velocity and strike_position of the first sphere"
"""Ends of the messages that refuse such a list as a factor."""
PARAMETERS: dict[str, Parameter] = {
    name: Parameter(
        *(name, units, text, tuple(path.split(".")), _CHOICES.get(name, ()), name in _WHOLE),
        any_word=name in WORDS,
    )
    for name, units, text, path in _ROWS
}


class Refinement(NamedTuple):
    """A parameter of the discretisation that a grid refines.

    axis: prefix of its variables in the analysis. cost_power: its power in the cost of a run; below
    zero, less is finer.
    """

    axis: str
    cost_power: int

    def finest_first(self, values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Return the positions of values, those of the finest grid first."""
        order = np.argsort(values)
        return order if self.cost_power < 0 else order[::-1]


REFINEMENTS = {
    "nodes": Refinement("nodes", 3),
    "points": Refinement("points", 1),
    "courant": Refinement("time_step", -1),
} | {
    size.name: Refinement(model.axis, size.cost_power)
    for model in wings.models().values()
    for size in model.sizes
}
"""Every refinement, by parameter."""


def flatten(impact: Impact, discretisation: Discretisation) -> dict[str, Value]:
    """Return every parameter's value by name, without those that are None (as mass may be)."""
    roots: dict[str, Any] = {"impact": impact, "discretisation": discretisation}
    values = {
        name: reduce(getattr, entry.path[1:], roots[entry.path[0]])
        for name, entry in PARAMETERS.items()
    }
    return {name: value for name, value in values.items() if value is not None}


def fixed_values(
    impact: Impact, discretisation: Discretisation, varied: Container[str]
) -> dict[str, Value]:
    """Return the values that all runs have, beside what is varied, by name of the parameter.

    Among them the shear coefficient of rectangles, which is a number of its own of other shapes.
    """
    values, beam = flatten(impact, discretisation), impact.beam
    if beam.shape == "rectangle" and "beam_shape" not in varied:
        values["shear_coefficient"] = beam.shear_correction
    return values


def with_values(
    impact: Impact, discretisation: Discretisation, values: Mapping[str, Value | Column]
) -> tuple[Impact, Discretisation]:
    """Return the base with the named parameters replaced, checked anew; a column is many runs.

    Raises ValueError for an unknown name, or where the model classes refuse a value.
    """
    tree: dict[str, Any] = {"impact": {}, "discretisation": {}}
    for name, value in values.items():
        if name not in PARAMETERS:
            near = did_you_mean(name, PARAMETERS)
            choices = ", ".join(PARAMETERS)
            raise ValueError(f"unknown parameter {name!r}{near or ':'} choose from {choices}")
        node = tree
        *parents, leaf = PARAMETERS[name].path
        for part in parents:
            node = node.setdefault(part, {})
        node[leaf] = value
    return _replaced(impact, tree["impact"]), _replaced(discretisation, tree["discretisation"])


def _replaced(node: Any, changes: Mapping[str, Any]) -> Any:
    """Return `node` with nested changes, its checks run on all of them at once."""
    fields = {
        key: _replaced(getattr(node, key), change) if isinstance(change, dict) else change
        for key, change in changes.items()
    }
    return replace(node, **fields) if fields else node
