"""Checks of the fields of the frozen model classes.

A column of values, for many runs at once, takes the place of a number, so that the rules are
written once. A refused column may still hold valid runs: then the runs are checked one by one.
"""

import math
from collections.abc import Collection, Iterable, Sequence
from difflib import get_close_matches
from numbers import Integral, Real
from typing import Any

import numpy as np

_MOST = 2**31 - 1  # the largest count; no memory holds so much


class Column(np.ndarray[Any, Any]):
    """One parameter's values, shape (runs,): float64, or words. Made by `column` alone."""


def column(values: Iterable[Any]) -> Column:
    """Return these values as one. Raises ValueError unless all are numbers, or all are words."""
    if not isinstance(values, np.ndarray) or values.dtype.kind == "O":
        values = list(values)
        if any(isinstance(value, bool | np.bool_) for value in values):
            raise ValueError("expected a number, not true or false")
    array = np.asarray(values)
    if array.ndim != 1 or array.dtype.kind not in "fiuU":
        raise ValueError("no column of numbers, nor of words")
    return (array if array.dtype.kind == "U" else array.astype(np.float64)).view(Column)


def require(holds: Any, owner: str, field: str, value: Any, message: str) -> None:
    """Raise ValueError naming the field and what it must be, unless `holds`: all of a column."""
    if holds is not True and not np.all(holds):
        # Python refuses to write out numbers of thousands of digits
        huge = isinstance(value, int) and value.bit_length() > 1024
        shown = f"a number of {value.bit_length()} bits" if huge else repr(value)
        raise ValueError(f"{owner}.{field} = {shown}: {message}")


def number(owner: str, field: str, value: Any) -> float:
    """Return `value` as a finite float. Raises ValueError naming `owner.field` otherwise."""
    message = "must be a finite number"
    if isinstance(value, Column):
        require(value.dtype.kind == "f" and np.isfinite(value), owner, field, value, message)
        return value  # type: ignore[return-value]
    real = isinstance(value, Real) and not isinstance(value, bool)
    try:
        sound = real and math.isfinite(value)
    except OverflowError:  # a whole number beyond what a float holds
        sound = False
    require(sound, owner, field, value, message)
    return float(value)


def positive(owner: str, field: str, value: Any) -> float:
    """Return `value` as a finite float above zero, or raise ValueError naming the field."""
    result = number(owner, field, value)
    require(result > 0, owner, field, value, "must be above zero")
    return result


def integer(owner: str, field: str, value: Any, least: int) -> int:
    """Return `value` as an int of at least `least`, or raise ValueError naming the field."""
    if isinstance(value, Column):
        holds = value.dtype.kind == "f" and (value == np.floor(value)) & (value >= least)
    else:
        holds = isinstance(value, Integral) or (isinstance(value, float) and value.is_integer())
        holds = holds and not isinstance(value, bool) and int(value) >= least
    require(holds, owner, field, value, f"must be a whole number of at least {least}")
    require(value <= _MOST, owner, field, value, f"must be at most {_MOST}")
    return value.astype(np.int64) if isinstance(value, Column) else int(value)  # type: ignore[return-value]


def one_of(owner: str, field: str, value: Any, choices: Sequence[str]) -> str:
    """Return `value` if it is among `choices`, or raise ValueError naming field and choices."""
    if isinstance(value, Column):
        listed = all(word in choices for word in set(value.tolist()))
    else:  # other arrays have no truth
        listed = isinstance(value, str) and value in choices
    nearest = "" if listed else did_you_mean(value, choices)
    require(listed, owner, field, value, f"must be one of {', '.join(choices)}{nearest}")
    return value if isinstance(value, Column) else str(value)  # type: ignore[return-value]


def among(value: Any, choices: Collection[str]) -> Any:
    """Return whether a word is one of these, for every word of a column."""
    return np.isin(value, [*choices]) if isinstance(value, Column) else value in choices


def did_you_mean(word: object, choices: Iterable[str]) -> str:
    """Return the question "; did you mean 'hertz'?" with the nearest choice; "" without any."""
    near = get_close_matches(word[:60], list(choices), n=1) if isinstance(word, str) else []
    return f"; did you mean {near[0]!r}?" if near else ""


def instance(owner: str, field: str, value: Any, kind: type) -> None:
    """Raise ValueError naming the field when `value` is not a `kind`."""
    article = "an" if kind.__name__[0] in "AEIOU" else "a"
    require(isinstance(value, kind), owner, field, value, f"must be {article} {kind.__name__}")
