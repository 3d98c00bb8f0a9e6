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
class AnalyticFunction:
    """A function of d parameters without unit.

    ranges: low and high of each parameter by its name. value: the function at points of shape
    (points, d), in the order of ranges.
    """

    title: str
    ranges: Mapping[str, tuple[float, float]]
    value: Callable[[Floats], Floats]


def _ishigami(x: Floats) -> Floats:
    """Return sin x1 + a sin^2 x2 + b x3^4 sin x1 with a = 7, b = 0.1.

    Source: Ishigami and Homma (1990), Proc. ISUMA '90, 398. It is not monotone, and x3 acts through
    its interaction with x1 alone.
    """
    sine = np.sin(x[:, 0])
    values: Floats = sine + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * sine
    return values


def _g(x: Floats) -> Floats:
    """Return Sobol's G function: the product of (|4 x_i - 2| + a_i)/(1 + a_i).

    Source: Saltelli and Sobol (1995), Reliab. Eng. Syst. Saf. 50, 225, with the usual eight a_i.
    """
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])
    values: Floats = np.prod((np.abs(4.0 * x - 2.0) + a) / (1.0 + a), axis=1)
    return values


FUNCTIONS = {
    "ishigami": AnalyticFunction(
        "Ishigami function", {f"x{i}": (-np.pi, np.pi) for i in (1, 2, 3)}, _ishigami
    ),
    "g": AnalyticFunction("Sobol's G function", {f"x{i}": (0.0, 1.0) for i in range(1, 9)}, _g),
}
"""Every function by its name in study files."""


def sources_hash() -> str:
    """Return the SHA-256 of this file, which changes with the functions."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()
