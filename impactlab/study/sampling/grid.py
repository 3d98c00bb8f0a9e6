"""Grid: every combination of listed values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from math import prod
from typing import Annotated, Any, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, TypeAdapter, ValidationInfo, model_validator

from impactlab.model.parameters import Parameter, Value
from impactlab.study.sampling.sections import Sampling
from impactlab.study.schema.parameters import value_type
from impactlab.study.schema.section import Section, Whole, at_key, one_of
from impactlab.study.validity import check_alone

Q = TypeVar("Q", bound=float)
MOST_VALUES = 10_000


class Range(Section, Generic[Q]):
    """`number` values from start to stop, both included, evenly spaced or in geometric sequence.

    Raises ValueError unless start < stop, and 0 < start where spacing is "log".
    """

    spacing: Annotated[str, one_of("spacing", ("linear", "log"))] = "linear"
    start: Q
    stop: Q
    number: Annotated[Whole, Field(ge=2, le=MOST_VALUES)]

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if self.start <= 0 and self.spacing == "log":
            raise at_key("start", "must be above zero for spacing: log")
        if self.stop <= self.start:
            raise at_key("stop", f"must be above start ({self.start!r})")
        return self

    def values(self, parameter: Parameter) -> list[Value]:
        """Return the values to 12 significant digits, so that 0.3 is selected as 0.3.

        Raises ValueError where the parameter takes whole numbers, and one of them is not.
        """
        space = np.geomspace if self.spacing == "log" else np.linspace
        spaced = space(self.start, self.stop, self.number)
        values: list[Value] = [float(f"{value:.12g}") for value in spaced]
        if not parameter.is_integer:
            return values
        for value in values:
            try:
                check_alone(parameter, value)
            except ValueError as error:
                raise ValueError(f"the range gives {value:g}: {error}; list the values") from None
        return [int(value) for value in values]


class Grid(Sampling):
    """The section `sampling` with method: grid.

    Combinations of the listed values are runs, the last parameter changing fastest.
    parameters: distinct values (SI numbers, or words) by parameter.
    """

    method: Literal["grid"]
    parameters: Mapping[str, tuple[Value, ...]]

    @staticmethod
    def read_entry(parameter: Parameter, data: Any, info: ValidationInfo) -> tuple[Value, ...]:
        """Read a parameter's distinct values: a list, or a range of numbers."""
        kind: Any = value_type(parameter)
        if isinstance(data, list):
            listed = Annotated[list[kind], Field(min_length=1, max_length=MOST_VALUES)]
            values: list[Value] = TypeAdapter(listed).validate_python(data)
        elif isinstance(data, dict) and not parameter.choices:
            values = Range[kind].model_validate(data, context=info.context).values(parameter)
        else:
            ranged = " or a range such as {start: 1, stop: 3, number: 5}"
            or_range = "" if parameter.choices else ranged
            raise ValueError(f"expected a list such as [1, 2, 3]{or_range}")
        if twice := [value for value, count in Counter(values).items() if count > 1]:
            once = "more than once: list each value once"
            raise ValueError(f"holds {twice[0]!r} (in SI units) {once}")
        return tuple(values)

    @property
    def runs(self) -> int:
        """Number of combinations."""
        return prod(len(values) for values in self.parameters.values())

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return the least and greatest value of each parameter, or all of its words."""
        return {
            name: values if isinstance(values[0], str) else (min(values), max(values))
            for name, values in self.parameters.items()
        }
