"""Values of parameters in study files, and the distributions of sampled ones."""

from __future__ import annotations

import math
from functools import cache, partial
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    Field,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from impactlab.model.distributions import ARGUMENTS, quantile
from impactlab.model.parameters import Parameter
from impactlab.study.schema.section import Number, Section, Whole, one_of, quantity, requires
from impactlab.study.validity import check_alone
from impactlab.types import Floats


def value_type(parameter: Parameter) -> Any:
    """Return the type of one value: a word, a whole number, or a number in SI units."""
    if parameter.choices:
        return Annotated[str, one_of(parameter.long_name, parameter.choices)]
    number = Whole if parameter.whole else quantity(parameter.units)
    return Annotated[number, AfterValidator(partial(check_alone, parameter))]


class Distribution(Section):
    """The distribution of one parameter, in SI units once read.

    Raises ValueError unless low < high, and for an interval that the draws can hardly reach.
    """

    distribution: str

    @field_validator("high", check_fields=False)
    @classmethod
    def _above_low(cls, high: float, info: ValidationInfo) -> float:
        low = info.data.get("low", -math.inf)
        if high <= low:
            fixed = "; for a single value write {distribution: fixed, value: ...}" * (high == low)
            raise ValueError(f"must be above low ({low!r}){fixed}")
        return high

    @field_validator("mode", check_fields=False)
    @classmethod
    def _between(cls, mode: float, info: ValidationInfo) -> float:
        low, high = (info.data.get(key, mode) for key in ("low", "high"))
        if not low <= mode <= high:
            raise ValueError(f"must lie from low to high ({low!r} to {high!r})")
        return mode

    @model_validator(mode="after")
    def _holds_something(self) -> Self:
        """Refuse an interval so far out in the tail that the quantiles lose their digits."""
        given = self.arguments()
        if given["distribution"] == "truncated_normal":
            mean, deviation = given["mean"], given["standard_deviation"]
            if (given["low"] - mean) / deviation > 8 or (given["high"] - mean) / deviation < -8:
                raise ValueError(
                    "low to high lies more than 8 standard deviations from the mean: "
                    "move them closer"
                )
        return self

    def quantile(self, probability: Floats) -> Floats:
        """Return the quantiles at these probabilities in (0, 1), of the same shape."""
        return quantile(self.arguments(), probability)

    def arguments(self) -> dict[str, Any]:
        """Return name and arguments as in the study file, in SI units."""
        return self.model_dump()

    def bounds(self) -> dict[str, float]:
        """Return the smallest and the largest draw, by key (low, high); empty when unbounded."""
        return {key: getattr(self, key) for key in ("low", "high") if hasattr(self, key)}


class Fixed(Section):
    """One value for all runs of a listed parameter, which is then not varied."""

    distribution: Literal["fixed"]
    value: Any


@cache  # equal studies hold sections of one class
def distribution_section(name: str, parameter: Parameter) -> type[Distribution | Fixed]:
    """Return the section of a distribution of this name (or "fixed") of a parameter."""
    value = value_type(parameter)
    if name == "fixed":
        return create_model("Fixed", __base__=Fixed, value=(value, ...))
    number, above_zero = quantity(parameter.units), Field(gt=0)
    words = "must be above 1 (with 1.1 most draws lie within 10 % of the median)"
    above_one = requires(lambda factor: factor > 1, words)
    types: dict[str, Any] = {
        "low": Annotated[value, above_zero] if name == "log_uniform" else value,
        "high": value,
        "mean": number,
        "mode": number,
        "median": Annotated[number, above_zero],
        "standard_deviation": Annotated[number, above_zero],
        "geometric_standard_deviation": Annotated[Number, above_one],
    }
    fields: Any = {key: (types[key], ...) for key in ARGUMENTS[name]}
    return create_model(name, __base__=Distribution, **fields)
