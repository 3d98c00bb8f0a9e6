"""Parameters that a study can vary, and the distributions of sampled ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Annotated, Any, Generic, Literal, TypeVar

from pydantic import AfterValidator, ValidationInfo, field_validator, model_validator

from impactlab.model.distributions import quantile
from impactlab.model.parameters import PARAMETERS, Parameter, Value
from impactlab.study.schema.section import (
    ABOVE_ZERO,
    Number,
    Reader,
    Section,
    Whole,
    at_key,
    one_of,
    quantity,
    requires,
    section_by,
)
from impactlab.study.validity import refused_alone
from impactlab.types import Floats


@dataclass(frozen=True)
class Factor:
    """A parameter as study files may vary it; refused: why no run can have a value, or ""."""

    parameter: Parameter
    refused: Callable[[Value], str]

    @property
    def type(self) -> Any:
        """Pydantic type of one value: a word, a whole number, or a number in SI units."""
        if self.parameter.choices:
            return Annotated[str, one_of(self.parameter.long_name, self.parameter.choices)]

        def possible(value: Value) -> Value:
            if reason := self.refused(value):
                raise ValueError(reason)
            return value

        number = Whole if self.parameter.whole else quantity(self.parameter.units)
        return Annotated[number, AfterValidator(possible)]


FACTORS = {name: Factor(entry, partial(refused_alone, name)) for name, entry in PARAMETERS.items()}
"""Parameters of an impact and its discretisation, by name."""

VALUES: dict[str, Any] = {name: factor.type for name, factor in FACTORS.items()}
"""Pydantic types of SI numbers and words, by the name of the parameter."""


Q = TypeVar("Q", bound=float)
"""A number in the parameter's unit; Number: a pure number."""


class Distribution(Section):
    """The distribution of one parameter, in SI units once read."""

    distribution: str

    def quantile(self, probability: Floats) -> Floats:
        """Return the quantiles at these probabilities in (0, 1), of the same shape."""
        return quantile(self.arguments(), probability)

    def arguments(self) -> dict[str, Any]:
        """Return name and arguments as in the study file, in SI units."""
        return self.model_dump()

    def bounds(self) -> dict[str, float]:
        """Return the smallest and the largest draw, by key (low, high); empty when unbounded."""
        return {key: getattr(self, key) for key in ("low", "high") if hasattr(self, key)}


class Bounded(Distribution, Generic[Q]):
    """A distribution between low and high. Raises ValueError unless low < high."""

    low: Q
    high: Q

    @field_validator("high")
    @classmethod
    def _above_low(cls, high: float, info: ValidationInfo) -> float:
        low = info.data.get("low", -math.inf)
        if high == low:
            raise ValueError(
                f"must be above low ({low!r}); "
                "for a single value write {distribution: fixed, value: ...}"
            )
        if high < low:
            raise ValueError(f"must be above low ({low!r})")
        return high


class Uniform(Bounded[Q], Generic[Q]):
    """Uniform distribution between low and high."""

    distribution: Literal["uniform"]


class LogUniform(Bounded[Q], Generic[Q]):
    """Uniform distribution of the logarithm, between those of low and high; low above zero."""

    distribution: Literal["log_uniform"]
    low: Annotated[Q, ABOVE_ZERO]


class Normal(Distribution, Generic[Q]):
    """Unbounded Gaussian; truncated_normal is safe for parameters that must stay positive."""

    distribution: Literal["normal"]
    mean: Q
    standard_deviation: Annotated[Q, ABOVE_ZERO]


class TruncatedNormal(Bounded[Q], Generic[Q]):
    """Gaussian cut off at low and high; mean and standard deviation are those before the cut."""

    distribution: Literal["truncated_normal"]
    mean: Q
    standard_deviation: Annotated[Q, ABOVE_ZERO]

    @model_validator(mode="after")
    def _holds_something(self) -> TruncatedNormal[Q]:
        """Refuse an interval so far out in the tail that the quantiles lose their digits."""
        near = (self.low - self.mean) / self.standard_deviation
        far = (self.high - self.mean) / self.standard_deviation
        if near > 8 or far < -8:
            raise ValueError(
                "low to high lies more than 8 standard deviations from the mean: move them closer"
            )
        return self


class LogNormal(Distribution, Generic[Q]):
    """Gaussian distribution of the logarithm.

    geometric_standard_deviation: the factor, above 1, within which 68 % of draws lie of the median.
    """

    distribution: Literal["lognormal"]
    median: Annotated[Q, ABOVE_ZERO]
    geometric_standard_deviation: Annotated[
        Number,
        requires(
            lambda factor: factor > 1,
            "must be above 1 (with 1.1 most draws lie within 10 % of the median)",
        ),
    ]


class Triangular(Bounded[Q], Generic[Q]):
    """Triangular density, highest at mode and zero at low and high."""

    distribution: Literal["triangular"]
    mode: Q

    @field_validator("mode")
    @classmethod
    def _between(cls, value: float, info: ValidationInfo) -> float:
        low, high = (info.data.get(key, value) for key in ("low", "high"))
        if not low <= value <= high:
            raise ValueError(f"must lie from low to high ({low!r} to {high!r})")
        return value


DISTRIBUTIONS: dict[str, Any] = {
    "uniform": Uniform,
    "log_uniform": LogUniform,
    "normal": Normal,
    "truncated_normal": TruncatedNormal,
    "lognormal": LogNormal,
    "triangular": Triangular,
}
"""By their names in study files; each takes the type of a number in the parameter's unit."""


V = TypeVar("V", bound=Value)


class Fixed(Section, Generic[V]):
    """One value for all runs of a listed parameter, which is then not varied."""

    distribution: Literal["fixed"]
    value: V


@cache
def distribution_reader(factor: Factor) -> Reader:
    """Return the reader of a Distribution within the model's limits, or of a Fixed value."""
    value_type: Any = factor.type
    sections: dict[str, type[Section]] = {"fixed": Fixed[value_type]}
    what = "a choice of words" if factor.parameter.choices else "a whole number"
    single = bool(factor.parameter.choices or factor.parameter.whole)
    if not single:
        sections = _distributions(factor.parameter.units) | sections
    read_any = section_by("distribution", sections)

    def read(data: Any, info: ValidationInfo) -> Any:
        if single and not (isinstance(data, dict) and data.get("distribution") == "fixed"):
            raise ValueError(
                f"is {what} and cannot be sampled: vary it in a study with method: grid, "
                "or write {distribution: fixed, value: ...}"
            )
        given = read_any(data, info)
        for key, value in given.bounds().items() if isinstance(given, Distribution) else ():
            if reason := factor.refused(value):
                raise at_key(key, reason)
        return given

    return read


@cache
def _distributions(units: str) -> dict[str, type[Section]]:
    return {name: form[quantity(units)] for name, form in DISTRIBUTIONS.items()}
