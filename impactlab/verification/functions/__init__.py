"""Functions whose sensitivity indices are known in closed form: one file each, a line in FUNCTIONS.

They take the place of the solver where a whole study, from its file to its report, is tested.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from impactlab.verification.functions import g, ishigami

Array = NDArray[np.float64]


class Function(Protocol):
    """What the file of a function offers; d is the number of its parameters, all without unit.

    The indices are those of parameters that are independent and uniform over their ranges.
    """

    TITLE: str
    RANGES: Mapping[str, tuple[float, float]]
    """Low and high of each parameter, by its name."""

    def value(self, x: Array) -> Array:
        """The function at points x of shape (points, d), in the order of RANGES."""
        ...

    def first_order(self) -> Array:
        """First-order Sobol indices (d,)."""
        ...

    def total_order(self) -> Array:
        """Total-order Sobol indices (d,)."""
        ...

    def second_order(self) -> Array:
        """Second-order Sobol indices (d, d), symmetric, NaN on the diagonal."""
        ...


FUNCTIONS: dict[str, Function] = {"ishigami": ishigami, "g": g}
"""By their name in study files."""


def sources_hash() -> str:
    """SHA-256 of this folder's files: changes with the functions."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
