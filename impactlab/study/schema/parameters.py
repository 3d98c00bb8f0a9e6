"""Values of parameters in study files, and the distributions of sampled ones."""

from __future__ import annotations

import math
import re
from functools import cache, partial
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    StrictStr,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from impactlab.model.distributions import ARGUMENTS, CHOICE, quantile
from impactlab.model.parameters import Parameter
from impactlab.study.schema.section import Number, Section, Whole, one_of, quantity, requires
from impactlab.study.validity import check_alone
from impactlab.types import Floats

LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}")
"""Names of a study's own; no formulas in tables, and no labels that a legend leaves out."""


def value_type(parameter: Parameter) -> Any:
    """Return the type of one value: a word, a whole number, or a number in SI units."""
    if parameter.choices:
        return Annotated[str, one_of(parameter.long_name, parameter.choices)]
    number = Whole if parameter.is_integer else quantity(parameter.units)
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
        fields = self.arguments()
        if fields["distribution"] == "truncated_normal":
            mean, deviation = fields["mean"], fields["standard_deviation"]
            if (fields["low"] - mean) / deviation > 8 or (fields["high"] - mean) / deviation < -8:
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


class Choice(Section):
    """A draw among words, in an order that has no meaning.

    weights: their probabilities, once read; by default equal.

    Raises ValueError unless there are two distinct words or more, with a weight each.
    """

    distribution: Literal["choice"]
    values: Any
    weights: list[Annotated[Number, Field(gt=0)]] | None = None

    @field_validator("values")
    @classmethod
    def _distinct(cls, values: list[str]) -> tuple[str, ...]:
        if twice := [word for index, word in enumerate(values) if word in values[:index]]:
            raise ValueError(f"names {twice[0]} more than once: name each word once")
        if len(values) < 2:
            raise ValueError(
                "needs two words or more: for a single one write {distribution: fixed, value: ...}"
            )
        return tuple(values)

    @field_validator("weights")
    @classmethod
    def _of_each(cls, weights: list[float], info: ValidationInfo) -> list[float]:
        choices = info.data.get("values", weights)
        if len(weights) != len(choices):
            raise ValueError(f"holds {len(weights)} for {len(choices)} words: give each word one")
        relative = np.array(weights) / max(weights)  # of which the sum is finite
        probabilities: list[float] = (relative / relative.sum()).tolist()
        return probabilities

    def quantile(self, probability: Floats) -> np.ndarray[Any, np.dtype[np.str_]]:
        """Return the words at these probabilities in (0, 1), in their order, of the same shape."""
        ends = np.cumsum(self.arguments()["weights"])[:-1]
        return np.array(self.values)[np.searchsorted(ends, probability, side="right")]

    def arguments(self) -> dict[str, Any]:
        """Return name, words and probabilities as lists, for the attributes of a dataset."""
        weights = self.weights or [1 / len(self.values)] * len(self.values)
        return {"distribution": CHOICE, "values": list(self.values), "weights": weights}


class Fixed(Section):
    """One value for all runs of a listed parameter, which is then not varied."""

    distribution: Literal["fixed"]
    value: Any


_LABELLED = requires(
    lambda text: bool(LABEL.fullmatch(text)),
    "is no word: use letters, digits, _ and -, starting with a letter or a digit",
)


@cache  # equal studies hold sections of one class
def distribution_section(name: str, parameter: Parameter) -> type[Distribution | Choice | Fixed]:
    """Return the section of a distribution of this name ("choice" or "fixed", too)."""
    value = value_type(parameter)
    if name == CHOICE:
        word: Any = value if parameter.choices else Annotated[StrictStr, _LABELLED]
        return create_model("Choice", __base__=Choice, values=(list[word], ...))
    if name == "fixed":
        return create_model("Fixed", __base__=Fixed, value=(value, ...))
    number, above_zero = quantity(parameter.units), Field(gt=0)
    message = "must be above 1 (with 1.1 most draws lie within 10 % of the median)"
    above_one = requires(lambda factor: factor > 1, message)
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
