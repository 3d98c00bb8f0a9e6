"""Grid: every combination of listed values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from math import prod
from typing import Annotated, Any, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, TypeAdapter, ValidationInfo, model_validator

from impactlab.model.parameters import Value
from impactlab.study.sampling.sections import Sampling
from impactlab.study.schema.parameters import Factor
from impactlab.study.schema.section import Reader, Section, Whole, at_key, between, one_of

Q = TypeVar("Q", bound=float)
MOST_VALUES = 10_000


class Range(Section, Generic[Q]):
    """`number` values from start to stop, both included, evenly spaced or in geometric sequence.

    Raises ValueError unless start < stop, and 0 < start where spacing is "log".
    """

    spacing: Annotated[str, one_of("spacing", ("linear", "log"))] = "linear"
    start: Q
    stop: Q
    number: Annotated[Whole, between(2, MOST_VALUES)]

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if self.start <= 0 and self.spacing == "log":
            raise at_key("start", "must be above zero for spacing: log")
        if self.stop <= self.start:
            raise at_key("stop", f"must be above start ({self.start!r})")
        return self

    def values(self, factor: Factor) -> list[Value]:
        """Return the values to 12 significant digits, so that 0.3 is selected as 0.3.

        Raises ValueError where the factor takes whole numbers, and one of them is not.
        """
        space = np.geomspace if self.spacing == "log" else np.linspace
        spaced = space(self.start, self.stop, self.number)
        values: list[Value] = [float(f"{value:.12g}") for value in spaced]
        if not factor.parameter.whole:
            return values
        for value in values:
            if reason := factor.refused(value):
                raise ValueError(f"the range gives {value:g}: {reason}; list the values")
        return [int(value) for value in values]


class Grid(Sampling):
    """The section `sampling` with method: grid.

    Every combination of the listed values is a run, the last parameter changing fastest.
    parameters: distinct values (SI numbers, or words) by parameter.
    """

    method: Literal["grid"]
    parameters: Mapping[str, tuple[Value, ...]]

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """Return the reader of a parameter's distinct values: a list, or a range of numbers."""
        value_type: Any = factor.type
        listed: TypeAdapter[list[Value]] = TypeAdapter(
            Annotated[list[value_type], Field(min_length=1, max_length=MOST_VALUES)]
        )
        ranged = None if factor.parameter.choices else Range[value_type]

        def read(data: Any, info: ValidationInfo) -> tuple[Value, ...]:
            if isinstance(data, list):
                values = listed.validate_python(data)
            elif ranged is None or not isinstance(data, dict):
                or_range = " or a range such as {start: 1, stop: 3, number: 5}" if ranged else ""
                raise ValueError(f"expected a list such as [1, 2, 3]{or_range}")
            else:
                values = ranged.model_validate(data, context=info.context).values(factor)
            if twice := [value for value, count in Counter(values).items() if count > 1]:
                once = "more than once: list each value once"
                raise ValueError(f"holds {twice[0]!r} (in SI units) {once}")
            return tuple(values)

        return read

    @property
    def runs(self) -> int:
        """Number of combinations."""
        return prod(len(values) for values in self.parameters.values())

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return the least and greatest value of each parameter."""
        return {name: (min(each), max(each)) for name, each in self.parameters.items()}
