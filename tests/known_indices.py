"""Sobol indices of the functions of impactlab.verification.functions in closed form."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Indices:
    """Indices of d parameters, independent and uniform over the function's ranges.

    first_order and total_order (d,); second_order (d, d), symmetric, NaN on the diagonal.
    """

    first_order: np.ndarray
    total_order: np.ndarray
    second_order: np.ndarray


def ishigami():
    """The parts of the variance are V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225.

    There are no others. Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398.
    """
    a, b = 7.0, 0.1
    v1 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2
    v2 = a**2 / 8.0
    v13 = 8.0 * b**2 * np.pi**8 / 225.0
    v = v1 + v2 + v13
    second_order = np.zeros((3, 3))
    second_order[0, 2] = second_order[2, 0] = v13 / v
    np.fill_diagonal(second_order, np.nan)
    return Indices(np.array([v1, v2, 0.0]) / v, np.array([v1 + v13, v2, v13]) / v, second_order)


def g():
    """A factor alone has the variance V_i = 1/(3 (1 + a_i)^2); products have 1 + V = prod(1 + V_i).

    S_i = V_i/V, S_ij = V_i V_j/V, T_i = V_i times the product of (1 + V_j) over the others, over V.
    Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225.
    """
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])
    parts = 1.0 / (3.0 * (1.0 + a) ** 2)
    v = float(np.prod(1.0 + parts) - 1.0)
    second_order = np.outer(parts, parts) / v
    np.fill_diagonal(second_order, np.nan)
    return Indices(parts / v, parts / (1.0 + parts) * (1.0 + v) / v, second_order)


INDICES = {"ishigami": ishigami(), "g": g()}
"""By the function's name in study files."""
