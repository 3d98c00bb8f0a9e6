"""Grid: every combination of listed values."""

from collections import Counter
from dataclasses import dataclass
from math import prod
from typing import Annotated, Any, Generic, Self, TypeVar

import numpy as np
from pydantic import Field, TypeAdapter, ValidationInfo, model_validator

from impactlab.methods.sampling import Sampling
from impactlab.model.parameters import Parameter, Value
from impactlab.validation.fields import FileSection, Whole, at_key, one_of, value_type
from impactlab.validation.refusals import check_alone

Q = TypeVar("Q", bound=float)
MOST_VALUES = 10_000


class Range(FileSection, Generic[Q]):
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


@dataclass(frozen=True, kw_only=True)
class Grid(Sampling):
    """A grid: all combinations of the listed values are runs, the last parameter changing fastest.

    Parameters
    ----------
    parameters : mapping of str to sequence of Quantity
        Values by name of the parameter (docs/studies.md lists the names).

    Examples
    --------
    >>> speeds = il.Grid(parameters={"velocity": ["50 cm/s", 1, 2], "contact": ["hertz", "mjg"]})
    """

    label = "grid"
    no_distribution = "the runs of a grid have no probabilities"

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

    def columns(self, start: int = 0, stop: int | None = None) -> dict[str, np.ndarray[Any, Any]]:
        """Return the values of each parameter in runs start to stop, one per run."""
        shape = [len(values) for values in self.parameters.values()]
        places = np.unravel_index(np.arange(start, self.runs if stop is None else stop), shape)
        columns = zip(self.parameters.items(), places, strict=True)
        return {name: np.array(values)[indices] for (name, values), indices in columns}

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Return the least and greatest value of each parameter, or all of its words."""
        return {
            name: values if isinstance(values[0], str) else (min(values), max(values))
            for name, values in self.parameters.items()
        }
