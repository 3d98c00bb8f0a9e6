"""A grid: every combination of listed values."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Literal

from impactlab.model.parameters import Value
from impactlab.study.declaration.axes import axis
from impactlab.study.declaration.form import Reader
from impactlab.study.declaration.methods.sampling import Sampling
from impactlab.study.declaration.values import Factor


class Grid(Sampling):
    """Every combination of the listed values, the last parameter changing fastest.

    parameters: distinct values (SI numbers, or words) by parameter.
    """

    method: Literal["grid"]
    parameters: Mapping[str, tuple[Value, ...]]

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """A list of values, or a range."""
        return axis(factor)

    @property
    def runs(self) -> int:
        """The number of combinations."""
        return prod(len(values) for values in self.parameters.values())

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Least and greatest value of each parameter."""
        return {name: (min(each), max(each)) for name, each in self.parameters.items()}
