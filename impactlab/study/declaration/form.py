"""What all parts of a study file have in common, and the small types of their values."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    PlainValidator,
    StrictStr,
    TypeAdapter,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

from impactlab.study.errors import unknown
from impactlab.study.quantities import si, whole

Reader = Callable[[Any, ValidationInfo], Any]
"""Turns what the file says into what it means; raises ValueError."""


class Form(BaseModel):
    """A mapping with fixed keys; any other key is refused.

    The keys allowed are noted in the context of the validation (by the mapping's id), so that a
    message about an unknown key can name them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _note_keys(cls, data: Any, info: ValidationInfo) -> Any:
        if info.context is not None:
            info.context[id(data)] = tuple(cls.model_fields)
        return data


def at_key(key: str, reason: str) -> PydanticCustomError:
    """An error that belongs to a (dotted) key below the mapping under validation."""
    return PydanticCustomError("at_key", "{reason}", {"key": key, "reason": reason})


def quantity(units: str) -> Any:
    """The type of a number in SI `units`, or a string with a unit of that dimension."""
    return Annotated[float, BeforeValidator(partial(si, units=units))]


def one_of(kind: str, choices: Collection[str]) -> BeforeValidator:
    """A check that a value is a word out of `choices`."""

    def check(value: object) -> object:
        if not isinstance(value, str) or value not in choices:
            raise ValueError(unknown(kind, value, choices))
        return value

    return BeforeValidator(check)


def names(kind: str, choices: Collection[str]) -> PlainValidator:
    """Reads `all`, or a list of some of the choices."""
    words: TypeAdapter[list[str]] = TypeAdapter(list[Annotated[str, one_of(kind, choices)]])

    def read(data: Any) -> tuple[str, ...]:
        if data == "all":
            return tuple(choices)
        if not isinstance(data, list) or not data:
            raise ValueError(f"expected `all`, or a list of names out of {', '.join(choices)}")
        found = words.validate_python(data)
        if twice := [name for at, name in enumerate(found) if name in found[:at]]:
            raise ValueError(f"names {twice[0]} more than once: name each {kind} once")
        return tuple(found)

    return PlainValidator(read)


def chosen(key: str, forms: Mapping[str, type[Form]]) -> Reader:
    """Reads a mapping by the form that its own entry at `key` names."""

    def read(data: Any, info: ValidationInfo) -> Form:
        if not isinstance(data, dict):
            raise ValueError(f"expected a mapping with the key {key} ({', '.join(forms)})")
        name = data.get(key)
        if key not in data:
            raise at_key(key, f"is required: choose from {', '.join(forms)}")
        if not isinstance(name, str) or name not in forms:
            raise at_key(key, unknown(key, name, forms))
        return forms[name].model_validate(data, context=info.context)

    return read


def above_zero(value: float) -> float:
    """The value. Raises ValueError unless it is above zero."""
    if value <= 0:
        raise ValueError("must be above zero")
    return value


def between(least: float, most: float) -> AfterValidator:
    """A check that a number lies from `least` to `most`."""

    def check(value: float) -> float:
        if not least <= value <= most:
            raise ValueError(f"must lie from {least:,} to {most:,}")
        return value

    return AfterValidator(check)


def _some(found: tuple[str, ...]) -> tuple[str, ...]:
    if not found:
        raise ValueError("is empty: list at least one name")
    return found


Names = Annotated[tuple[StrictStr, ...], AfterValidator(_some)]
"""A list of words, at least one."""
Number = Annotated[float, BeforeValidator(partial(si, units="1"))]
"""A pure number."""
Whole = Annotated[int, BeforeValidator(whole)]
"""A whole number."""
