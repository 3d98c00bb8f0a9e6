"""The sections `impact` and `discretisation`, read as objects of the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import reduce
from typing import Annotated, Any

from pydantic import ValidationInfo, WrapValidator, create_model

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, Parameter, with_values
from impactlab.study.schema.parameters import VALUES
from impactlab.study.schema.section import Number, Section, at_key, between, names, one_of
from impactlab.study.validity import Base, refusal
from impactlab.variables import RESPONSES

BASES = {"paper": paper_impact}
"""Impacts that a study may start from, by name."""

_ROOTS = {"impact": paper_impact(), "discretisation": Discretisation()}


def read_impact(data: Any, info: ValidationInfo) -> Impact:
    """Read an impact: a base with changes, or every value spelled out.

    Raises ValueError (pydantic's ValidationError among them) that names the keys at fault.
    """
    section: Any = _IMPACT.model_validate(data, context=info.context)
    given = _given_values(section, "impact")
    if section.base is None:
        required = [name for name, value in _DEFAULTS.items() if value is MISSING]
        if missing := [_key(name) for name in required if name not in given]:
            raise ValueError(f"without `base: paper` these are required too: {', '.join(missing)}")
        given = _DEFAULTS | given
    return _changed((BASES[section.base or "paper"](), Discretisation()), given)[0]


class Auto(Section):
    """The key `auto`: a discretisation to be found by pilot runs on corner cases of the study.

    tolerance: relative numerical uncertainty; responses: those that it limits; None: all.
    """

    tolerance: Annotated[Number, between(1e-4, 0.5)] = 0.01
    responses: Annotated[tuple[str, ...], names("response", RESPONSES)] | None = None


@dataclass(frozen=True)
class DiscretisationSection:
    """The section `discretisation`: its values, and how to find the others, if at all."""

    discretisation: Discretisation
    auto: Auto | None = None


def read_discretisation(data: Any, info: ValidationInfo) -> DiscretisationSection:
    """Read a discretisation; a value that is left out has the model's default.

    Raises ValueError (pydantic's ValidationError among them) that names the keys at fault.
    """
    section: Any = _DISCRETISATION.model_validate(
        {"auto": {}} if data == "auto" else data, context=info.context
    )
    given = _given_values(section, "discretisation")
    for name in given.keys() & {"nodes", "points", "courant"} if section.auto else ():
        raise at_key(name, "cannot be given beside auto, which finds it: take out one of the two")
    return DiscretisationSection(
        _changed((paper_impact(), Discretisation()), given)[1], section.auto
    )


def _section(*path: str, **others: Any) -> type[Section]:
    """Return the section of a part of the model, with a key per field, from PARAMETERS."""
    keys: dict[str, Any] = {}
    for name, entry in PARAMETERS.items():
        if entry.path[: len(path)] == path:
            key, *deeper = entry.path[len(path) :]
            keys[key] = (_section(*path, key) if deeper else _type(name), None)
    return create_model("_".join(path), __base__=Section, **(others | keys))


def _default(parameter: Parameter) -> Any:
    """Return the default that the model's class gives a field, or MISSING."""
    owner: Any = reduce(getattr, parameter.path[1:-1], _ROOTS[parameter.path[0]])
    return next(field.default for field in fields(owner) if field.name == parameter.path[-1])


def _type(name: str) -> Any:
    """Return the type of a value in a section; null is allowed where it is the default."""
    if _default(PARAMETERS[name]) is not None:
        return VALUES[name]
    nothing = WrapValidator(lambda value, read: None if value is None else read(value))
    return Annotated[VALUES[name], nothing]


def _given_values(section: Section, root: str) -> dict[str, Any]:
    """Return the values in a section, by the name of the parameter."""
    tree = {root: section.model_dump(exclude_unset=True)}
    given = {}
    for name, entry in PARAMETERS.items():
        node: Any = tree
        for step in entry.path:
            node = node.get(step, MISSING) if isinstance(node, dict) else MISSING
        if node is not MISSING:
            given[name] = node
    return given


def _changed(base: Base, values: Mapping[str, Any]) -> Base:
    if found := refusal(base, values):
        raise at_key(_key(found.name), found.reason)
    return with_values(*base, values)


def _key(name: str) -> str:
    """Return the key of a parameter, below its section."""
    return ".".join(PARAMETERS[name].path[1:])


_DEFAULTS = {
    name: _default(entry) for name, entry in PARAMETERS.items() if entry.path[0] == "impact"
}
_IMPACT = _section("impact", base=(Annotated[str, one_of("base", BASES)], None))
_DISCRETISATION = _section("discretisation", auto=(Auto | None, None))
