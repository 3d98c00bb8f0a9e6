"""Functions on the unit cube whose Sobol indices are known in closed form."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Known:
    """A function of d independent parameters, uniform in 0..1, with its variance and indices.

    first_order and total_order (d,); second_order (d, d), symmetric, NaN on the diagonal.
    """

    of_unit: Callable[[Any], Any]
    variance: float
    first_order: np.ndarray
    total_order: np.ndarray
    second_order: np.ndarray

    @property
    def size(self):
        return len(self.first_order)


def ishigami():
    """The parts of the variance are V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225.

    There are no others. Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398.
    """
    a, b = 7.0, 0.1

    def of_unit(unit):
        x = np.pi * (2 * unit - 1)
        return np.sin(x[..., 0]) * (1 + b * x[..., 2] ** 4) + a * np.sin(x[..., 1]) ** 2

    v1 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2
    v2 = a**2 / 8.0
    v13 = 8.0 * b**2 * np.pi**8 / 225.0
    v = v1 + v2 + v13
    second_order = np.zeros((3, 3))
    second_order[0, 2] = second_order[2, 0] = v13 / v
    np.fill_diagonal(second_order, np.nan)
    first_order, total_order = np.array([v1, v2, 0.0]), np.array([v1 + v13, v2, v13])
    return Known(of_unit, v, first_order / v, total_order / v, second_order)


def g(*coefficients):
    """A factor alone has the variance V_i = 1/(3 (1 + a_i)^2); products have 1 + V = prod(1 + V_i).

    S_i = V_i/V, S_ij = V_i V_j/V, T_i = V_i times the product of (1 + V_j) over the others, over V.
    Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225.
    """
    a = np.array(coefficients)
    parts = 1.0 / (3.0 * (1.0 + a) ** 2)
    v = float(np.prod(1.0 + parts) - 1.0)
    second_order = np.outer(parts, parts) / v
    np.fill_diagonal(second_order, np.nan)

    def of_unit(unit):
        return np.prod((np.abs(4 * unit - 2) + a) / (1 + a), axis=-1)

    total_order = parts / (1.0 + parts) * (1.0 + v) / v
    return Known(of_unit, v, parts / v, total_order, second_order)


INDICES = {"ishigami": ishigami(), "g": g(0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0)}
"""By the function's name in study files."""
