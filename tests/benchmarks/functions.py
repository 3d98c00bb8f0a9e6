"""Functions of the unit cube with known parts of their variance, for measurements of coverage."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Case:
    """A function of the unit cube; parts: of its variance, by the factors that interact."""

    groups: Sequence[str]
    function: Callable[[Any], Any]
    parts: Mapping[tuple[int, ...], float]

    def exact(self) -> dict[str, Any]:
        """Return the indices of all orders."""
        factors, whole = len(set(self.groups)), sum(self.parts.values())

        def share(holds: Callable[[tuple[int, ...]], bool]) -> float:
            return sum(part for key, part in self.parts.items() if holds(key)) / whole

        pairs = combinations(range(factors), 2)
        return {
            "first_order": [self.parts.get((i,), 0.0) / whole for i in range(factors)],
            "total_order": [share(lambda key, i=i: i in key) for i in range(factors)],
            "second_order": [self.parts.get(pair, 0.0) / whole for pair in pairs],
        }


def names(count: int) -> list[str]:
    """Return the names of parameters without groups."""
    return [f"x{at}" for at in range(count)]


def linear(*slopes: float) -> Case:
    """Return a sum of terms."""
    parts = {(at,): slope**2 for at, slope in enumerate(slopes)}
    return Case(names(len(slopes)), lambda x: x @ np.array(slopes), parts)


def g(*weights: float) -> Case:
    """Return Sobol's G function (Saltelli and Sobol 1995)."""
    a, keys = np.array(weights), range(len(weights))
    alone = 1 / (3 * (1 + a) ** 2)
    subsets = (key for size in keys for key in combinations(keys, size + 1))
    parts = {key: float(np.prod(alone[list(key)])) for key in subsets}
    return Case(names(a.size), lambda x: np.prod((abs(4 * x - 2) + a) / (1 + a), axis=1), parts)


def ishigami(*groups: str) -> Case:
    """Return Ishigami's function, of x0 and x2 in one group where there are two."""

    def function(unit: Any) -> Any:
        x = np.pi * (2 * unit - 1)
        return np.sin(x[:, 0]) * (1 + 0.1 * x[:, 2] ** 4) + 7 * np.sin(x[:, 1]) ** 2

    one, two = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 49 / 8
    both = 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
    grouped = {(0,): one + both, (1,): two}
    return Case(
        groups, function, grouped if len(set(groups)) == 2 else {(0,): one, (1,): two, (0, 2): both}
    )
