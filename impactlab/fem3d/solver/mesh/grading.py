"""Points on a line, fine at its beginning and coarser with the distance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Floats = NDArray[np.float64]


def uniform(size: float, length: float) -> int:
    """Number of intervals of at most `size` in `length` (both in m), at least 1."""
    return max(math.ceil(length / size * (1.0 - 1e-9)), 1)


def graded(size: float, fine: float, length: float, ratio: float, largest: float) -> Floats:
    """Coordinates in m, from 0 to `length`: intervals of `size` up to `fine`, then growing.

    ratio: at most, of neighbouring intervals beyond `fine`, until they reach `largest`; it is
    lowered so that the last point falls on `length`. `fine` must be a multiple of `size`, or reach
    `length`, which is then cut into equal intervals.
    """
    if fine >= length * (1.0 - 1e-9):
        return np.linspace(0.0, length, uniform(size, length) + 1)
    start = size * np.arange(round(fine / size) + 1)
    points = np.concatenate([start, start[-1] + _grown(size, length - start[-1], ratio, largest)])
    points[-1] = length
    return points


def _grown(size: float, rest: float, ratio: float, largest: float) -> Floats:
    """Ends of intervals that fill `rest` (m), none much smaller than `size`."""
    count = 1
    while _intervals(size, count, ratio, largest).sum() < rest:
        count += 1
    if count * size >= rest:
        return np.linspace(0.0, rest, max(count - 1, 1) + 1)[1:]
    fits = brentq(
        lambda r: _intervals(size, count, r, largest).sum() - rest, 1.0, ratio, xtol=1e-14
    )
    return np.cumsum(_intervals(size, count, fits, largest))


def _intervals(size: float, count: int, ratio: float, largest: float) -> Floats:
    return np.asarray(np.minimum(size * ratio ** np.arange(1.0, count + 1), max(largest, size)))
