"""Sobol's G function: the product of (|4 x_i - 2| + a_i)/(1 + a_i) over eight parameters.

Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225, with the usual
a = 0, 1, 4.5, 9, 99, 99, 99, 99. Over 0 to 1 a factor alone has the variance
V_i = 1/(3 (1 + a_i)^2); products of factors have 1 + V = product of (1 + V_i).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TITLE = "Sobol's G function"
A = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])
RANGES: Mapping[str, tuple[float, float]] = {f"x{at}": (0.0, 1.0) for at in range(1, A.size + 1)}

_PARTS = 1.0 / (3.0 * (1.0 + A) ** 2)
_V = float(np.prod(1.0 + _PARTS) - 1.0)


def value(x: Array) -> Array:
    """The function at points x (points, 8)."""
    found: Array = np.prod((np.abs(4.0 * x - 2.0) + A) / (1.0 + A), axis=1)
    return found


def first_order() -> Array:
    """V_i/V."""
    found: Array = _PARTS / _V
    return found


def total_order() -> Array:
    """V_i times the product of (1 + V_j) over the others, over V."""
    found: Array = _PARTS / (1.0 + _PARTS) * (1.0 + _V) / _V
    return found


def second_order() -> Array:
    """V_i V_j/V."""
    indices = np.outer(_PARTS, _PARTS) / _V
    np.fill_diagonal(indices, np.nan)
    return indices
