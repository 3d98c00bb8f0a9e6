"""Checks that the frozen model classes make of their own fields."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TypeGuard

_MOST = 2**31 - 1
"""The largest count; no memory holds so much."""


def number(owner: str, field: str, value: object) -> float:
    """`value` as a finite float. Raises ValueError naming `owner.field` otherwise."""
    if isinstance(value, bool) or not isinstance(value, Real) or not _finite(value):
        raise ValueError(f"{owner}.{field} = {_shown(value)}: must be a finite number")
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
        raise ValueError(
            f"{owner}.{field} = {_shown(value)}: must be a whole number of at least {least}"
        )
    if (result := int(value)) > _MOST:  # type: ignore[call-overload]
        raise ValueError(f"{owner}.{field} = {_shown(value)}: must be at most {_MOST}")
    return result  # type: ignore[no-any-return]


def one_of(owner: str, field: str, value: object, choices: tuple[str, ...]) -> str:
    """`value` if it is among `choices`, or a ValueError naming the field and the choices."""
    if not isinstance(value, str) or value not in choices:  # an array has no truth
        raise ValueError(f"{owner}.{field} = {value!r}: must be one of {', '.join(choices)}")
    return str(value)


def instance(owner: str, field: str, value: object, kind: type) -> None:
    """Raises ValueError naming the field when `value` is not a `kind`."""
    if not isinstance(value, kind):
        raise ValueError(f"{owner}.{field} = {value!r}: must be a {kind.__name__}")


def _finite(value: Real) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond what a float holds
        return False


def _shown(value: object) -> str:
    """The value as it is written; Python refuses to write out numbers of thousands of digits."""
    return f"a number of {value.bit_length()} bits" if _is_huge(value) else repr(value)


def _is_huge(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and value.bit_length() > 1024
