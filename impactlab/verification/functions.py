"""Functions whose sensitivity indices are known in closed form.

They take the place of the solver where a whole study, from its file to its report, is tested.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from impactlab.types import Floats


@dataclass(frozen=True)
class Function:
    """A function of d parameters without unit, and its Sobol indices.

    ranges: low and high of each parameter by its name. value: the function at points of shape
    (points, d), in the order of ranges. The indices are those of parameters that are independent
    and uniform over their ranges: first_order and total_order (d,), second_order (d, d), symmetric,
    NaN on the diagonal.
    """

    title: str
    ranges: Mapping[str, tuple[float, float]]
    value: Callable[[Floats], Floats]
    first_order: Floats
    total_order: Floats
    second_order: Floats


def _ishigami() -> Function:
    """Return f = sin x1 + a sin^2 x2 + b x3^4 sin x1 with a = 7, b = 0.1.

    Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398. It is not monotone, and x3 acts through
    its interaction with x1 alone. Over -pi to pi the parts of the variance are V1 =
    (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225, and no others.
    """
    a, b = 7.0, 0.1

    def value(x: Floats) -> Floats:
        sine = np.sin(x[:, 0])
        found: Floats = sine + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * sine
        return found

    v1 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2
    v2 = a**2 / 8.0
    v13 = 8.0 * b**2 * np.pi**8 / 225.0
    v = v1 + v2 + v13
    second_order = np.zeros((3, 3))
    second_order[0, 2] = second_order[2, 0] = v13 / v
    np.fill_diagonal(second_order, np.nan)
    return Function(
        "Ishigami function",
        {f"x{at}": (-np.pi, np.pi) for at in (1, 2, 3)},
        value,
        np.array([v1, v2, 0.0]) / v,
        np.array([v1 + v13, v2, v13]) / v,
        second_order,
    )


def _g() -> Function:
    """Return Sobol's G function: the product of (|4 x_i - 2| + a_i)/(1 + a_i).

    Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225, with the usual eight
    a = 0, 1, 4.5, 9, 99, 99, 99, 99. Over 0 to 1 a factor alone has the variance
    V_i = 1/(3 (1 + a_i)^2); products of factors have 1 + V = product of (1 + V_i). S_i = V_i/V,
    S_ij = V_i V_j/V, T_i = V_i times the product of (1 + V_j) over the others, over V.
    """
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])

    def value(x: Floats) -> Floats:
        found: Floats = np.prod((np.abs(4.0 * x - 2.0) + a) / (1.0 + a), axis=1)
        return found

    parts = 1.0 / (3.0 * (1.0 + a) ** 2)
    v = float(np.prod(1.0 + parts) - 1.0)
    second_order = np.outer(parts, parts) / v
    np.fill_diagonal(second_order, np.nan)
    return Function(
        "Sobol's G function",
        {f"x{at}": (0.0, 1.0) for at in range(1, a.size + 1)},
        value,
        parts / v,
        parts / (1.0 + parts) * (1.0 + v) / v,
        second_order,
    )


FUNCTIONS = {"ishigami": _ishigami(), "g": _g()}
"""Every function by its name in study files."""


def sources_hash() -> str:
    """Return the SHA-256 of this file, which changes with the functions."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()
