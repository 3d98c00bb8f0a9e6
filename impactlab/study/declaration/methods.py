"""How the runs of a study are chosen: one class a method, and one entry in METHODS."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from functools import cache
from math import prod
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    PlainValidator,
    StrictBool,
    ValidationInfo,
    create_model,
    model_validator,
)

from impactlab.model.parameters import PARAMETERS, Parameter, Value
from impactlab.study.declaration.axes import axis
from impactlab.study.declaration.distributions import DISTRIBUTIONS, Distribution
from impactlab.study.declaration.form import Form, Reader, Whole, at_key, between, chosen, quantity
from impactlab.study.declaration.values import VALUES
from impactlab.study.possible import check_alone

MOST_RUNS = 10_000_000


def _by_parameter(reader_of: Callable[[Parameter], Reader]) -> PlainValidator:
    """Reads a mapping from names of parameters, in the order of the file."""
    entries: Any = {
        name: (Annotated[Any, PlainValidator(reader_of(entry))], None)
        for name, entry in PARAMETERS.items()
    }
    form = create_model("Parameters", __base__=Form, **entries)

    def read(data: Any, info: ValidationInfo) -> dict[str, Any]:
        given = form.model_validate(data, context=info.context)
        return {name: getattr(given, name) for name in data}

    return PlainValidator(read)


def _axis(parameter: Parameter) -> Reader:
    return axis(parameter, VALUES[parameter.name])


def _power_of_two(value: int) -> int:
    if value & (value - 1):
        below = 1 << (value.bit_length() - 1)
        raise ValueError(f"must be a power of two, such as {below} or {2 * below}")
    return value


@cache
def _distributions(units: str) -> dict[str, type[Form]]:
    return {name: form[quantity(units)] for name, form in DISTRIBUTIONS.items()}


def _distribution(parameter: Parameter) -> Reader:
    """Reads a distribution whose bounds, where it has any, the model allows."""
    if parameter.choices or parameter.whole:
        return _refuse_sampling(parameter)
    read_any = chosen("distribution", _distributions(parameter.units))

    def read(data: Any, info: ValidationInfo) -> Distribution:
        given: Distribution = read_any(data, info)
        for key, value in given.bounds().items():
            try:
                check_alone(parameter.name, value)
            except ValueError as error:
                raise at_key(key, str(error)) from None
        return given

    return read


def _refuse_sampling(parameter: Parameter) -> Reader:
    what = "a choice of words" if parameter.choices else "a whole number"

    def read(data: Any, info: ValidationInfo) -> Any:
        raise ValueError(f"is {what} and cannot be sampled: vary it in a study with method: grid")

    return read


class Sampling(Form):
    """Which parameters are varied, in the order of the file, and how."""

    fewest: ClassVar[int] = 1

    method: str
    parameters: Mapping[str, Any]

    @property
    @abstractmethod
    def runs(self) -> int:
        """How many runs the study has."""

    @abstractmethod
    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Least and greatest number of each bounded parameter, or any one word."""

    @model_validator(mode="after")
    def _bearable(self) -> Self:
        if len(self.parameters) < self.fewest:
            reason = f"too few: method {self.method} varies {self.fewest} or more"
            raise at_key("parameters", reason)
        if self.runs > MOST_RUNS:
            raise ValueError(f"makes {self.runs:,} runs: at most {MOST_RUNS:,} are possible")
        return self


class Grid(Sampling):
    """Every combination of the listed values, the last parameter changing fastest.

    parameters: distinct values (SI numbers, or words) by parameter.
    """

    method: Literal["grid"]
    parameters: Annotated[Mapping[str, tuple[Value, ...]], _by_parameter(_axis)]

    @property
    def runs(self) -> int:
        """The number of combinations."""
        return prod(len(values) for values in self.parameters.values())

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Least and greatest value of each parameter."""
        return {name: (min(each), max(each)) for name, each in self.parameters.items()}


class Sobol(Sampling):
    """Saltelli's sample for Sobol indices, of parameters that vary independently.

    base_samples: N, a power of two. second_order: whether second-order indices are wanted; they
    take N (2 D + 2) runs of D parameters instead of N (D + 2). seed: the same one gives the same
    draws, 0 like any other.
    """

    fewest: ClassVar[int] = 2

    method: Literal["sobol"]
    base_samples: Annotated[Whole, between(2, MOST_RUNS), AfterValidator(_power_of_two)]
    second_order: StrictBool = True
    seed: Annotated[Whole, between(0, 2**32 - 1)] = 1
    parameters: Annotated[Mapping[str, Distribution], _by_parameter(_distribution)]

    @property
    def runs(self) -> int:
        """Saltelli's number of runs."""
        count = len(self.parameters)
        return self.base_samples * (2 * count + 2 if self.second_order else count + 2)

    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Low and high of the bounded distributions."""
        found = {name: tuple(each.bounds().values()) for name, each in self.parameters.items()}
        return {name: ends for name, ends in found.items() if ends}


METHODS: dict[str, type[Form]] = {"grid": Grid, "sobol": Sobol}
"""By their name in study files."""

read_sampling = chosen("method", METHODS)
"""Reads the section `sampling` by the method that it names."""
