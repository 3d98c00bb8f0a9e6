"""Checks that the frozen model classes make of their own fields."""

from __future__ import annotations

import math
from numbers import Integral, Real


def number(owner: str, field: str, value: object) -> float:
    """`value` as a finite float. Raises ValueError naming `owner.field` otherwise."""
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise ValueError(f"{owner}.{field} = {value!r}: must be a finite number")
    return float(value)


def positive(owner: str, field: str, value: object) -> float:
    """`value` as a finite float above zero, or a ValueError naming the field."""
    if (result := number(owner, field, value)) <= 0:
        raise ValueError(f"{owner}.{field} = {value!r}: must be above zero")
    return result


def not_negative(owner: str, field: str, value: object) -> float:
    """`value` as a finite float of zero or more, or a ValueError naming the field."""
    if (result := number(owner, field, value)) < 0:
        raise ValueError(f"{owner}.{field} = {value!r}: must not be negative")
    return result


def integer(owner: str, field: str, value: object, least: int) -> int:
    """`value` as an int of at least `least`, or a ValueError naming the field."""
    whole = isinstance(value, Integral) or (isinstance(value, float) and value.is_integer())
    if isinstance(value, bool) or not whole or int(value) < least:  # type: ignore[call-overload]
        raise ValueError(f"{owner}.{field} = {value!r}: must be a whole number of at least {least}")
    return int(value)  # type: ignore[call-overload, no-any-return]


def one_of(owner: str, field: str, value: object, choices: tuple[str, ...]) -> str:
    """`value` if it is among `choices`, or a ValueError naming the field and the choices."""
    if value not in choices:
        raise ValueError(f"{owner}.{field} = {value!r}: must be one of {', '.join(choices)}")
    return str(value)
