"""Functions whose sensitivity indices are known in closed form.

They take the place of the solver where a whole study, from its file to its report, is tested.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from impactlab.types import Floats

_A = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])
"""The coefficients a_i of Sobol's G function."""


@dataclass(frozen=True)
class AnalyticFunction:
    """A function of d parameters without unit.

    ranges: low and high of each parameter by its name. value: the function at points of shape
    (points, d), in the order of ranges. total_order: the Sobol indices of parameters that are
    uniform over these ranges, (d,).
    """

    title: str
    ranges: Mapping[str, tuple[float, float]]
    value: Callable[[Floats], Floats]
    total_order: Floats


def _ishigami(x: Floats) -> Floats:
    """Return sin x1 + a sin^2 x2 + b x3^4 sin x1 with a = 7, b = 0.1.

    Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398. It is not monotone, and x3 acts through
    its interaction with x1 alone.
    """
    sine = np.sin(x[:, 0])
    values: Floats = sine + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * sine
    return values


def _ishigami_total_order() -> Floats:
    """Return the total orders: the variances of x1, x2, and of x1 with x3 over that of all."""
    a, b, fourth = 7.0, 0.1, np.pi**4
    first, second = 0.5 * (1.0 + b * fourth / 5.0) ** 2, a**2 / 8.0
    both = 8.0 * b**2 * fourth**2 / 225.0
    return np.array([first + both, second, both]) / (first + second + both)


def _g(x: Floats) -> Floats:
    """Return Sobol's G function: the product of (|4 x_i - 2| + a_i)/(1 + a_i).

    Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225, with the usual eight a_i.
    """
    values: Floats = np.prod((np.abs(4.0 * x - 2.0) + _A) / (1.0 + _A), axis=1)
    return values


def _g_total_order() -> Floats:
    """Return the total orders: 1 + V is the mean square of a factor, its mean is 1."""
    variances = 1.0 / (3.0 * (1.0 + _A) ** 2)
    products = np.prod(1.0 + variances)
    shares: Floats = variances / (1.0 + variances) * products / (products - 1.0)
    return shares


FUNCTIONS = {
    "ishigami": AnalyticFunction(
        "Ishigami function",
        {f"x{i}": (-np.pi, np.pi) for i in (1, 2, 3)},
        _ishigami,
        _ishigami_total_order(),
    ),
    "g": AnalyticFunction(
        "Sobol's G function", {f"x{i}": (0.0, 1.0) for i in range(1, 9)}, _g, _g_total_order()
    ),
}
"""Every function by its name in study files."""


def sources_hash() -> str:
    """Return the SHA-256 of this file, which changes with the functions."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()
