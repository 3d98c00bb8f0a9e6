"""The sections `impact` and `discretisation` of a study file, read as objects of the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import reduce
from typing import Annotated, Any

from pydantic import ValidationInfo, WrapValidator, create_model

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS, Parameter, with_values
from impactlab.study.declaration.form import Form, Number, at_key, between, names, one_of
from impactlab.study.declaration.values import VALUES
from impactlab.study.validity import Base, refusal
from impactlab.variables import RESPONSES

BASES = {"paper": paper_impact}
"""Impacts that a study may start from, by name."""

_ROOTS = {"impact": paper_impact(), "discretisation": Discretisation()}


def read_impact(data: Any, info: ValidationInfo) -> Impact:
    """The impact of the section: a base with changes, or everything spelled out.

    Raises ValueError (pydantic's ValidationError among them) that names the keys at fault.
    """
    form: Any = _IMPACT.model_validate(data, context=info.context)
    stated = _stated(form, "impact")
    if form.base is None:
        required = [name for name, value in _DEFAULTS.items() if value is MISSING]
        if missing := [_key(name) for name in required if name not in stated]:
            raise ValueError(f"without `base: paper` these are required too: {', '.join(missing)}")
        stated = _DEFAULTS | stated
    return _changed((BASES[form.base or "paper"](), Discretisation()), stated)[0]


class Auto(Form):
    """A discretisation that is to be found: by trials on the corner cases of the study.

    tolerance: relative numerical uncertainty; responses: those that it is asked of.
    """

    tolerance: Annotated[Number, between(1e-4, 0.5)] = 0.01
    responses: Annotated[tuple[str, ...], names("response", RESPONSES)] | None = None


@dataclass(frozen=True)
class Chosen:
    """The section `discretisation`: what it states, and how the rest is found, if it is."""

    discretisation: Discretisation
    auto: Auto | None = None


def read_discretisation(data: Any, info: ValidationInfo) -> Chosen:
    """The discretisation of the section; what it leaves out has the model's default.

    Raises ValueError (pydantic's ValidationError among them) that names the keys at fault.
    """
    form: Any = _DISCRETISATION.model_validate(
        {"auto": {}} if data == "auto" else data, context=info.context
    )
    stated = _stated(form, "discretisation")
    for name in stated.keys() & {"nodes", "points", "courant"} if form.auto else ():
        raise at_key(name, "cannot be stated beside auto, which finds it: take out one of the two")
    return Chosen(_changed((paper_impact(), Discretisation()), stated)[1], form.auto)


def _section(*path: str, **others: Any) -> type[Form]:
    """The form of a part of the model: one key a field, as the paths of PARAMETERS say."""
    keys: dict[str, Any] = {}
    for name, entry in PARAMETERS.items():
        if entry.path[: len(path)] == path:
            key, *deeper = entry.path[len(path) :]
            keys[key] = (_section(*path, key) if deeper else _type(name), None)
    return create_model("_".join(path), __base__=Form, **(others | keys))


def _default(parameter: Parameter) -> Any:
    """The default that the model's class gives a field, or MISSING."""
    owner: Any = reduce(getattr, parameter.path[1:-1], _ROOTS[parameter.path[0]])
    return next(field.default for field in fields(owner) if field.name == parameter.path[-1])


def _type(name: str) -> Any:
    """The type of a value in a section; null stands where it is the model's own default."""
    if _default(PARAMETERS[name]) is not None:
        return VALUES[name]
    nothing = WrapValidator(lambda value, read: None if value is None else read(value))
    return Annotated[VALUES[name], nothing]


def _stated(form: Form, section: str) -> dict[str, Any]:
    """What a section states, by the name of the parameter."""
    tree = {section: form.model_dump(exclude_unset=True)}
    stated = {}
    for name, entry in PARAMETERS.items():
        node: Any = tree
        for step in entry.path:
            node = node.get(step, MISSING) if isinstance(node, dict) else MISSING
        if node is not MISSING:
            stated[name] = node
    return stated


def _changed(base: Base, values: Mapping[str, Any]) -> Base:
    if found := refusal(base, values):
        raise at_key(_key(found.name), found.reason)
    return with_values(*base, values)


def _key(name: str) -> str:
    """Where a parameter is stated, below its section."""
    return ".".join(PARAMETERS[name].path[1:])


_DEFAULTS = {
    name: _default(entry) for name, entry in PARAMETERS.items() if entry.path[0] == "impact"
}
_IMPACT = _section("impact", base=(Annotated[str, one_of("base", BASES)], None))
_DISCRETISATION = _section("discretisation", auto=(Auto | None, None))
