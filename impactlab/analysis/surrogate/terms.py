"""Which polynomials a chaos may be made of."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Degrees = NDArray[np.int64]
"""(terms, parameters): the degree of each term's polynomial in each parameter."""

_NORM = 0.7
"""q of the norm: with 1 all terms up to a total degree; with less, fewer interactions."""
_ROUNDING = 1e-9


def candidates(parameters: int, most: int, highest: int) -> Degrees:
    """The largest hyperbolic set of at most `most` terms, the constant first.

    A set holds the terms whose degrees a_i keep to (sum a_i^q)^(1/q) <= p with q = 0.7; p is at
    most `highest`. Blatman and Sudret (2011), J. Comput. Phys. 230, 2345, eq. 24.
    """
    found = hyperbolic(parameters, 0)
    for degree in range(1, highest + 1):
        larger = hyperbolic(parameters, degree)
        if len(larger) > most:
            break
        found = larger
    return found


@cache
def hyperbolic(parameters: int, degree: int) -> Degrees:
    """All terms up to this degree, by total degree, then in the order of the parameters."""
    rows = [(0,) * parameters, *_within(parameters, degree)]
    rows.sort(key=lambda row: (sum(row), [-part for part in row]))
    return np.array(rows, dtype=np.int64)


def _within(parameters: int, degree: int) -> list[tuple[int, ...]]:
    """The terms but the constant one: each grows from one without its last active parameter."""
    limit = degree**_NORM + _ROUNDING
    found: list[tuple[int, ...]] = []
    grown = [((0,) * parameters, 0, 0.0)]
    while grown:
        row, start, used = grown.pop()
        for at in range(start, parameters):
            for part in range(1, degree + 1):
                total = used + part**_NORM
                if total > limit:
                    break
                longer = (*row[:at], part, *row[at + 1 :])
                found.append(longer)
                grown.append((longer, at + 1, total))
    return found
