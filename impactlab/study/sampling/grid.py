"""Grid: every combination of listed values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from math import prod
from typing import Annotated, Any, Generic, Literal, TypeVar

import numpy as np
from pydantic import Field, TypeAdapter, ValidationInfo, field_validator

from impactlab.model.parameters import Value
from impactlab.study.sampling.sections import Sampling, SamplingMethod
from impactlab.study.schema.parameters import Factor
from impactlab.study.schema.section import Reader, Section, Whole, between, one_of

Q = TypeVar("Q", bound=float)
MOST_VALUES = 10_000
_LIST = "a list such as [1, 2, 3]"
_RANGE = "a range such as {start: 1, stop: 3, number: 5}"


class Range(Section, Generic[Q]):
    """`number` values from start to stop, both included, evenly spaced or in geometric sequence.

    Raises ValueError unless start < stop, and 0 < start where spacing is "log".
    """

    spacing: Annotated[str, one_of("spacing", ("linear", "log"))] = "linear"
    start: Q
    stop: Q
    number: Annotated[Whole, between(2, MOST_VALUES)]

    @field_validator("start")
    @classmethod
    def _has_logarithm(cls, value: float, info: ValidationInfo) -> float:
        if value <= 0 and info.data.get("spacing") == "log":
            raise ValueError("must be above zero for spacing: log")
        return value

    @field_validator("stop")
    @classmethod
    def _above_start(cls, value: float, info: ValidationInfo) -> float:
        if "start" in info.data and value <= info.data["start"]:
            raise ValueError(f"must be above start ({info.data['start']!r})")
        return value

    def values(self) -> list[float]:
        """Return the values to 12 significant digits, so that 0.3 is selected as 0.3."""
        space = np.geomspace if self.spacing == "log" else np.linspace
        return [float(f"{value:.12g}") for value in space(self.start, self.stop, self.number)]


class Grid(Sampling):
    """The section `sampling` with method: grid.

    Every combination of the listed values is a run, the last parameter changing fastest.
    parameters: distinct values (SI numbers, or words) by parameter.
    """

    method: Literal["grid"]
    parameters: Mapping[str, tuple[Value, ...]]

    @staticmethod
    def entry(factor: Factor) -> Reader:
        """Return the reader of a list of values, or of a range."""
        return values_reader(factor)

    @property
    def runs(self) -> int:
        """Number of combinations."""
        return prod(len(values) for values in self.parameters.values())

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return the least and greatest value of each parameter."""
        return {name: (min(each), max(each)) for name, each in self.parameters.items()}


def values_reader(factor: Factor) -> Reader:
    """Return the reader of a parameter's distinct values: a list, or a range of numbers."""
    value_type: Any = factor.type
    listed: TypeAdapter[list[Value]] = TypeAdapter(
        Annotated[list[value_type], Field(min_length=1, max_length=MOST_VALUES)]
    )
    ranged = None if factor.parameter.choices else Range[value_type]

    def read(data: Any, info: ValidationInfo) -> tuple[Value, ...]:
        if isinstance(data, list):
            return _distinct(listed.validate_python(data))
        if ranged is None or not isinstance(data, dict):
            raise ValueError(f"expected {_LIST}" + (f" or {_RANGE}" if ranged else ""))
        return _distinct(_expanded(factor, ranged.model_validate(data, context=info.context)))

    return read


def _expanded(factor: Factor, given: Range[Any]) -> list[Value]:
    values: list[Value] = list(given.values())
    if not factor.parameter.whole:
        return values
    for value in values:
        try:
            factor.check(value)
        except ValueError as error:
            raise ValueError(f"the range gives {value:g}: {error}; list the values") from None
    return [int(value) for value in values]


def _distinct(values: list[Value]) -> tuple[Value, ...]:
    if twice := [value for value, count in Counter(values).items() if count > 1]:
        raise ValueError(f"holds {twice[0]!r} (in SI units) more than once: list each value once")
    return tuple(values)


METHOD = SamplingMethod(
    name="grid", section=Grid, summary="every combination of listed values or ranges"
)
