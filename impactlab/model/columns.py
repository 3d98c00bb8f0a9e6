"""Many runs at once: a column of values stands in a field of the model where one number would.

The model's classes check a column as they check a number, so that the rules are written once.
What they do not take as a column may still be right: then the runs are checked one by one.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np


class Column(np.ndarray[Any, Any]):
    """One parameter's values, shape (runs,): float64, or words. Made by `column` alone."""


def column(values: Iterable[Any]) -> Column:
    """Return the values as a column. Raises ValueError unless all are numbers, or all are words."""
    if not isinstance(values, np.ndarray) or values.dtype.kind == "O":
        values = list(values)
        if any(isinstance(value, bool | np.bool_) for value in values):
            raise ValueError("a truth is no number")
    array = np.asarray(values)
    if array.ndim != 1 or array.dtype.kind not in "fiuU":
        raise ValueError("no column of numbers, nor of words")
    return (array if array.dtype.kind == "U" else array.astype(np.float64)).view(Column)


def anywhere(condition: Any) -> bool:
    """Return whether a comparison holds, for a number or for any value of a column."""
    return bool(condition.any()) if isinstance(condition, np.ndarray) else bool(condition)
