"""Values that the model refuses, by the names of parameters."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, Parameter, Value, with_values
from impactlab.model.plausibility import without_unit
from impactlab.model.section import SHAPES, THICKNESSES, section_fields

Base = tuple[Impact, Discretisation]

_FIELD_REFUSED = re.compile(r"\w+\.(\w+) = .*?: (.*)", re.DOTALL)
"""The wording of the model's classes."""


@dataclass(frozen=True)
class Refusal:
    """A parameter that the model refuses, the reason, and the values that were tried."""

    name: str
    reason: str
    values: Mapping[str, Any]


def _by_owner(names: Iterable[str]) -> dict[tuple[str, ...], list[str]]:
    """Return names of parameters by the part of the model that has them."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for name in names:
        groups.setdefault(PARAMETERS[name].path[:-1], []).append(name)
    return dict(sorted(groups.items()))


def refusal(base: Base, values: Mapping[str, Value | None]) -> Refusal | None:
    """Return the first parameter that the model refuses when `values` replace the base's."""
    for owner, (first, *others) in _by_owner(values).items():
        group: dict[str, Any] = {name: values[name] for name in (first, *others)}
        try:
            with_values(*base, group)
        except ValueError as error:
            match = _FIELD_REFUSED.fullmatch(str(error))
            remark = without_unit(group)
            if match is None:
                return Refusal(first, f"{error}{remark}", group)
            path = (*owner, match[1])
            named = (name for name, entry in PARAMETERS.items() if entry.path == path)
            return Refusal(next(named, first), f"{match[2]}{remark}", group)
    return None


def refused_corner(base: Base, extremes: Mapping[str, Iterable[Value]]) -> Refusal | None:
    """Return the first combination of extreme values that the model refuses.

    The model's limits on numbers are orderings (0 < E, yield stress < E, depth < span), so values
    inside a box are valid where all its corners are. Parameters of different bodies are not
    combined, because the model does not compare them.
    """
    for names in _by_owner(extremes).values():
        for corner in product(*(extremes[name] for name in names)):
            if refused := refusal(base, dict(zip(names, corner, strict=True))):
                return refused
    return None


def check_alone(parameter: Parameter, value: Value) -> Value:
    """Return the value. Raises ValueError with the model's reason where no impact can have it.

    A parameter of a test function, which is no part of the model, can have any value.
    """
    values = {parameter.name: value} | _section_around(parameter.name, value)
    if parameter.path and (refused := refusal(_ROOMY, values)):
        raise ValueError(refused.reason)
    return value


def _section_around(name: str, value: Value) -> dict[str, Value]:
    """Return the sizes with which a shape, or a thickness, makes a section; none for others."""
    shape = {"beam_wall_thickness": "box", "beam_flange_thickness": "i", "beam_web_thickness": "i"}
    shape["beam_shape"] = str(value)
    if shape.get(name) not in SHAPES or shape[name] == "rectangle":
        return {}
    sizes: dict[str, Value] = dict.fromkeys(("beam_width", "beam_depth"), 1e299)
    if shape[name] == "profile":
        sizes["beam_profile"] = "0 1, 1 1"
    if shape[name] == "laminate":
        sizes["beam_layers"] = "0.5 1 0.1 1"
    thin = (f"beam_{field}" for field in section_fields(shape[name]) if field in THICKNESSES)
    sizes |= dict.fromkeys(thin, 1e-300) | {"beam_shape": shape[name]}
    return {field: size for field, size in sizes.items() if field != name}


_ROOMY: Base = with_values(
    paper_impact(),
    Discretisation(),
    dict.fromkeys(("sphere_youngs_modulus", "beam_youngs_modulus", "beam_span"), 1e300)
    | dict.fromkeys(("sphere_yield_stress", "beam_yield_stress", "beam_depth"), 1e-300)
    | dict.fromkeys(("support_left", "support_right"), "free"),
)
"""An impact with which only the limits of a parameter itself apply."""
