"""Distributions of a sampled parameter: one class each, and one entry in DISTRIBUTIONS."""

from __future__ import annotations

import math
from typing import Annotated, Any, Generic, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, ValidationInfo, field_validator, model_validator

from impactlab.model.distributions import quantile
from impactlab.study.declaration.form import Form, Number, above_zero

Q = TypeVar("Q", bound=float)
"""A number in the parameter's unit; Number: a pure number."""
Values = NDArray[np.float64]


def _above_low(high: float, info: ValidationInfo) -> float:
    low = info.data.get("low", -math.inf)
    if high == low:
        raise ValueError(
            f"must be above low ({low!r}); "
            "what has one value is written {distribution: fixed, value: ...}"
        )
    if high < low:
        raise ValueError(f"must be above low ({low!r})")
    return high


class Distribution(Form):
    """What one parameter may be, in SI units once read."""

    distribution: str

    def quantile(self, probability: Values) -> Values:
        """The values (same shape) below which a draw lies with these probabilities in (0, 1)."""
        return quantile(self.arguments(), probability)

    def arguments(self) -> dict[str, Any]:
        """Name and arguments as in the study file, in SI units."""
        return self.model_dump()

    def bounds(self) -> dict[str, float]:
        """The smallest and the largest draw, by key (low, high); empty when unbounded."""
        return {key: getattr(self, key) for key in ("low", "high") if hasattr(self, key)}


class Bounded(Distribution, Generic[Q]):
    """Between low and high. Raises ValueError unless low < high."""

    low: Q
    high: Q

    _order = field_validator("high")(_above_low)


class Uniform(Bounded[Q], Generic[Q]):
    """Every value between low and high equally likely."""

    distribution: Literal["uniform"]


class LogUniform(Bounded[Q], Generic[Q]):
    """The logarithm uniform between those of low and high; low above zero."""

    distribution: Literal["log_uniform"]

    _positive = field_validator("low")(above_zero)


class Normal(Distribution, Generic[Q]):
    """Gaussian, unbounded: for what must stay positive, truncated_normal is safe."""

    distribution: Literal["normal"]
    mean: Q
    standard_deviation: Annotated[Q, AfterValidator(above_zero)]


class TruncatedNormal(Bounded[Q], Generic[Q]):
    """Gaussian given that it lies between low and high; mean and deviation before the cut."""

    distribution: Literal["truncated_normal"]
    mean: Q
    standard_deviation: Annotated[Q, AfterValidator(above_zero)]

    @model_validator(mode="after")
    def _holds_something(self) -> TruncatedNormal[Q]:
        """Refuse an interval so far out in the tail that the quantiles lose their digits."""
        near = (self.low - self.mean) / self.standard_deviation
        far = (self.high - self.mean) / self.standard_deviation
        if near > 8 or far < -8:
            raise ValueError("low to high lies more than 8 standard deviations from the mean")
        return self


class LogNormal(Distribution, Generic[Q]):
    """The logarithm Gaussian: 68 % of draws within a factor of the median.

    geometric_standard_deviation: that factor, above 1, without unit.
    """

    distribution: Literal["lognormal"]
    median: Annotated[Q, AfterValidator(above_zero)]
    geometric_standard_deviation: Number

    @field_validator("geometric_standard_deviation")
    @classmethod
    def _above_one(cls, value: float) -> float:
        if value <= 1:
            raise ValueError("must be above 1 (1.1: most draws within 10 % of the median)")
        return value


class Triangular(Bounded[Q], Generic[Q]):
    """Most likely at mode, falling linearly to nothing at low and high."""

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
"""By their name in study files; each takes the type of a number in the parameter's unit."""
