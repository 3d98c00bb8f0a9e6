"""Arrays that compiled code may hand around for nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.core import cgutils
from numba.extending import intrinsic, overload

from impactlab.kernels.jit import compiled
from impactlab.kernels.types import Array

_null: Any = cgutils.get_null_value  # numba has no types here
ONE, TWO = np.uint64(1), np.uint64(2)
"""Offsets for an unsigned index. A loop over one gets vectorised from wherever it begins; a signed
index might be negative, that is, count from the end."""


def lent(array: Array) -> Array:
    """The same array without a count of its references: its owner must outlive the loan.

    A compiled function counts the references to every array that it is given up and down, which
    in a hot loop costs more than the work.
    """
    return array


@compiled
def end_loan(owner: Any) -> None:
    """Say that what was lent of `owner` (an array, or a tuple of them) is not used any more.

    Compiled code frees an array after its last use: without this call after the loan that is
    where it is lent, and what borrows it works on memory that is another's by then.
    """


def _make_view(context: Any, array: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = _null(view.meminfo.type)
        return view._getvalue()

    return array(array), generate


_without_owner: Any = intrinsic(_make_view)


@overload(lent, strict=False)
def _lent(array: Any) -> Any:
    return lambda array: _without_owner(array)
