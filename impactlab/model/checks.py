"""Checks that the frozen model classes make of their own fields: a number each, or a column."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any

import numpy as np

from impactlab.model.columns import Column, anywhere

_EXACT = 2.0**53
"""From here on not every whole number is a float."""


def number(owner: str, field: str, value: Any) -> float:
    """`value` as a finite float. Raises ValueError naming `owner.field` otherwise."""
    if isinstance(value, Column):
        sound = value.dtype.kind == "f" and bool(np.isfinite(value).all())
    else:
        real = isinstance(value, Real) and not isinstance(value, bool)
        sound = real and math.isfinite(value)
    if not sound:
        raise ValueError(f"{owner}.{field} = {value!r}: must be a finite number")
    return value if isinstance(value, Column) else float(value)  # type: ignore[return-value]


def positive(owner: str, field: str, value: Any) -> float:
    """`value` as a finite float above zero, or a ValueError naming the field."""
    if anywhere((result := number(owner, field, value)) <= 0):
        raise ValueError(f"{owner}.{field} = {value!r}: must be above zero")
    return result


def not_negative(owner: str, field: str, value: Any) -> float:
    """`value` as a finite float of zero or more, or a ValueError naming the field."""
    if anywhere((result := number(owner, field, value)) < 0):
        raise ValueError(f"{owner}.{field} = {value!r}: must not be negative")
    return result


def integer(owner: str, field: str, value: Any, least: int) -> int:
    """`value` as an int of at least `least`, or a ValueError naming the field."""
    if isinstance(value, Column):
        whole = value.dtype.kind == "f" and bool(np.all(value == np.floor(value)))
        whole = whole and bool(np.all((value >= least) & (value < _EXACT)))
    else:
        whole = isinstance(value, Integral) or (isinstance(value, float) and value.is_integer())
        whole = whole and not isinstance(value, bool) and int(value) >= least
    if not whole:
        raise ValueError(f"{owner}.{field} = {value!r}: must be a whole number of at least {least}")
    return value.astype(np.int64) if isinstance(value, Column) else int(value)  # type: ignore[return-value]


def one_of(owner: str, field: str, value: Any, choices: tuple[str, ...]) -> str:
    """`value` if it is among `choices`, or a ValueError naming the field and the choices."""
    among = set(value.tolist()) <= set(choices) if isinstance(value, Column) else value in choices
    if not among:
        raise ValueError(f"{owner}.{field} = {value!r}: must be one of {', '.join(choices)}")
    return value if isinstance(value, Column) else str(value)  # type: ignore[return-value]
