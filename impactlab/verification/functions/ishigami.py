"""The Ishigami function: f = sin x1 + a sin^2 x2 + b x3^4 sin x1 with a = 7, b = 0.1.

Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398. It is not monotone, and x3 acts through
its interaction with x1 alone. Over -pi to pi the parts of the variance are V1 =
(1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225, and no others.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TITLE = "Ishigami function"
RANGES: Mapping[str, tuple[float, float]] = {f"x{at}": (-np.pi, np.pi) for at in (1, 2, 3)}
A, B = 7.0, 0.1

_V1 = 0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2
_V2 = A**2 / 8.0
_V13 = 8.0 * B**2 * np.pi**8 / 225.0
_V = _V1 + _V2 + _V13


def value(x: Array) -> Array:
    """The function at points x (points, 3)."""
    sine = np.sin(x[:, 0])
    found: Array = sine + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * sine
    return found


def first_order() -> Array:
    """S1 = V1/V, S2 = V2/V, S3 = 0."""
    return np.array([_V1, _V2, 0.0]) / _V


def total_order() -> Array:
    """T1 = (V1 + V13)/V, T2 = V2/V, T3 = V13/V."""
    return np.array([_V1 + _V13, _V2, _V13]) / _V


def second_order() -> Array:
    """S13 = V13/V, all others 0."""
    indices = np.zeros((3, 3))
    indices[0, 2] = indices[2, 0] = _V13 / _V
    np.fill_diagonal(indices, np.nan)
    return indices
