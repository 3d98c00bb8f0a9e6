"""Distributions of varied parameters: sections of a study, and between values and probabilities.

A distribution is stored by name and arguments in SI units: the attributes of a varied coordinate of
runs.nc, whose other attributes do not matter here. A new one is a class here, and a line in
impactlab/__init__.pyi.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike
from pydantic import Field, PlainValidator, ValidationInfo, field_validator, model_validator

from impactlab.methods.entries import (
    ABOVE_ONE,
    Centre,
    Distribution,
    Entry,
    Positive,
    PositiveValue,
    Value,
    read_value,
    read_whole,
    read_words,
)
from impactlab.model.quantities import Quantity
from impactlab.types import Floats
from impactlab.validation.fields import Number, Whole

_ROUNDING = 1e-9  # of numbers of steps


@dataclass(frozen=True)
class Uniform(Distribution):
    """Equal probability from `low` to `high`.

    Parameters
    ----------
    low, high : Quantity
        Ends of the range, in the parameter's unit.

    Examples
    --------
    >>> il.Uniform("26 mm", "29 mm")
    Uniform(low='26 mm', high='29 mm')
    """

    low: Value
    high: Value

    def _frozen(self) -> Any:
        return scipy.stats.uniform(self.low, self.high - self.low)


@dataclass(frozen=True)
class LogUniform(Distribution):
    """Equal probability of the logarithm, from `low` to `high`.

    Parameters
    ----------
    low, high : Quantity
        Ends of the range, above zero, in the parameter's unit.

    Examples
    --------
    >>> speed = il.LogUniform("0.1 m/s", "10 m/s")
    """

    low: PositiveValue
    high: Value
    is_logarithmic = True

    def _frozen(self) -> Any:
        return scipy.stats.loguniform(self.low, self.high)


@dataclass(frozen=True)
class Normal(Distribution):
    """A normal distribution; for bounded parameters `TruncatedNormal` is safer.

    Parameters
    ----------
    mean : Quantity
        Mean, in the parameter's unit.
    standard_deviation : Quantity
        Standard deviation, in the parameter's unit.

    Examples
    --------
    >>> stress = il.Normal("345 MPa", "20 MPa")
    """

    mean: Centre
    standard_deviation: Positive

    def _frozen(self) -> Any:
        return scipy.stats.norm(self.mean, self.standard_deviation)


@dataclass(frozen=True)
class TruncatedNormal(Distribution):
    """A normal distribution that is cut at `low` and `high`.

    Parameters
    ----------
    mean : Quantity
        Mean before the cut, in the parameter's unit.
    standard_deviation : Quantity
        Standard deviation before the cut, in the parameter's unit.
    low, high : Quantity
        Ends of the range, in the parameter's unit.

    Examples
    --------
    >>> stress = il.TruncatedNormal("345 MPa", "25 MPa", low="270 MPa", high="420 MPa")
    """

    mean: Centre
    standard_deviation: Positive
    low: Value
    high: Value

    @property
    def _cuts(self) -> tuple[float, float]:
        """The ends, in standard deviations from the mean."""
        low, high = self.low - self.mean, self.high - self.mean
        return low / self.standard_deviation, high / self.standard_deviation

    def _frozen(self) -> Any:
        return scipy.stats.truncnorm(*self._cuts, self.mean, self.standard_deviation)

    @model_validator(mode="after")
    def _holds_something(self) -> Self:
        """Refuse an interval so far out in the tail that the quantiles lose their digits."""
        low, high = self._cuts
        if low > 8 or high < -8:
            raise ValueError(
                "low to high lies more than 8 standard deviations from the mean: move them closer"
            )
        return self


@dataclass(frozen=True)
class Lognormal(Distribution):
    """A normal distribution of the logarithm.

    Parameters
    ----------
    median : Quantity
        Median, in the parameter's unit.
    geometric_standard_deviation : float
        Factor above 1: 68 % of draws lie within this factor of the median (1.1: about ± 10 %).

    Examples
    --------
    >>> stress = il.Lognormal("345 MPa", 1.1)
    """

    median: Positive
    geometric_standard_deviation: Annotated[Number, ABOVE_ONE]
    is_logarithmic = True

    def _frozen(self) -> Any:
        return scipy.stats.lognorm(np.log(self.geometric_standard_deviation), scale=self.median)


@dataclass(frozen=True)
class Triangular(Distribution):
    """A density that rises from `low` to `mode` and falls to `high`.

    Parameters
    ----------
    low, high : Quantity
        Ends of the range, in the parameter's unit.
    mode : Quantity
        Most probable value, in the parameter's unit.

    Examples
    --------
    >>> stiffness = il.Triangular("190 GPa", "210 GPa", "230 GPa")
    """

    low: Value
    mode: Value
    high: Value

    def _frozen(self) -> Any:
        base = self.high - self.low
        return scipy.stats.triang((self.mode - self.low) / base, self.low, base)


@dataclass(frozen=True)
class Steps(Distribution):
    """Equal probability of the values from `low` to `high` at one distance, both among them.

    For `Sobol`, whose indices allow for runs of equal value.

    Parameters
    ----------
    low, high : Quantity
        Least and greatest value, in the parameter's unit.
    step : Quantity
        Distance of neighbouring values, which divides that of the ends.

    Examples
    --------
    >>> place, stock = il.Steps(0.2, 0.5, 0.05), il.Steps("10 mm", "30 mm", "5 mm")
    """

    low: Value
    high: Value
    step: Positive
    is_discrete = True

    @field_validator("step")
    @classmethod
    def _check_step(cls, step: float, info: ValidationInfo) -> float:
        if {"low", "high"} <= info.data.keys():
            steps = (info.data["high"] - info.data["low"]) / step
            if abs(steps - round(steps)) > _ROUNDING * max(steps, 1.0):
                raise ValueError("does not lead from low to high in whole steps")
        return step

    @property
    def count(self) -> int:
        """Number of the values that may be drawn."""
        steps: int = round((self.high - self.low) / self.step)
        return steps + 1

    def at_steps(self, steps: Any) -> Any:
        """Return the values (same shape) that so many steps lead to from `low`."""
        values = self.low + steps * ((self.high - self.low) / (self.count - 1))
        return np.where(steps == self.count - 1, self.high, values)

    def steps_to(self, values: ArrayLike) -> Floats:
        """Return the numbers of steps (same shape) to the nearest values that may be drawn."""
        return np.asarray(np.rint((np.asarray(values) - self.low) / self.step))

    def _frozen(self) -> Any:
        """Return the distribution of the number of steps above `low`."""
        return scipy.stats.randint(0, self.count)

    def quantile(self, probability: ArrayLike) -> Any:
        """Return the values (same shape) below or at which a draw lies at least so often."""
        steps = np.asarray(self._frozen().ppf(probability)).astype(np.int64)
        return self.at_steps(np.maximum(steps, 0))

    def at_scores(self, scores: ArrayLike) -> Any:
        """Return the values (same shape) at standard normal scores."""
        return self.quantile(scipy.special.ndtr(scores))

    def cumulative(self, values: ArrayLike) -> Floats:
        """Return the probabilities (same shape) that a draw lies at or below these values."""
        steps = (np.asarray(values) - self.low) / self.step
        return np.asarray(self._frozen().cdf(steps + _ROUNDING * self.count))

    def scores(self, values: ArrayLike) -> Floats:
        """Return the scores (same shape) in the middle of those of each value."""
        return np.asarray(scipy.special.ndtri((self.steps_to(values) + 0.5) / self.count))


@dataclass(frozen=True)
class Integers(Steps):
    """Equal probability of the whole numbers from `low` to `high`, both among them.

    For `Sobol`, whose indices allow for runs of equal value.

    Parameters
    ----------
    low, high : int
        Least and greatest number.
    step : int, default 1
        Distance of neighbouring numbers, which divides that of the ends: nodes are odd and have 2.

    Examples
    --------
    >>> strikes, nodes = il.Integers(1, 20), il.Integers(21, 81, step=20)
    """

    low: Annotated[Quantity, PlainValidator(read_whole)]
    high: Annotated[Quantity, PlainValidator(read_whole)]
    step: Annotated[Whole, Field(ge=1)] = 1

    def at_steps(self, steps: Any) -> Any:
        """Return the whole numbers (same shape) that so many steps lead to from `low`."""
        return int(self.low) + int(self.step) * np.asarray(steps, dtype=np.int64)


@dataclass(frozen=True)
class Choice(Entry):
    """One of several words, such as contact laws.

    For `Sobol`, `Delta` and `Pawn`, which need no order of the values.

    Parameters
    ----------
    values : sequence of str
        Two words or more.
    weights : sequence of float, optional
        Relative probability of each word, above zero; equal by default.

    Examples
    --------
    >>> law = il.Choice(["stronge", "mjg", "thornton"], weights=[2, 1, 1])
    """

    values: Annotated[Sequence[str], PlainValidator(read_words)]
    weights: list[Annotated[Number, Field(gt=0)]] | None = None

    @field_validator("values")
    @classmethod
    def _check_distinct(cls, values: tuple[str, ...]) -> tuple[str, ...]:
        if twice := [word for index, word in enumerate(values) if word in values[:index]]:
            raise ValueError(f"names {twice[0]} more than once: name each word once")
        if len(values) < 2:
            raise ValueError(
                "needs two words or more: for a single one write {distribution: fixed, value: ...}"
            )
        return values

    @field_validator("weights")
    @classmethod
    def _check_number(cls, weights: list[float] | None, info: ValidationInfo) -> list[float] | None:
        choices = info.data.get("values", weights)
        if weights is None or choices is None:
            return None
        if len(weights) != len(choices):
            raise ValueError(f"holds {len(weights)} for {len(choices)} words: give each word one")
        relative = np.array(weights) / max(weights)  # of which the sum is finite
        probabilities: list[float] = (relative / relative.sum()).tolist()
        return probabilities

    def quantile(self, probability: Floats) -> np.ndarray[Any, np.dtype[np.str_]]:
        """Return the words at these probabilities in (0, 1), in their order, of the same shape."""
        ends = np.cumsum(self.arguments()["weights"])[:-1]
        return np.array(self.values)[np.searchsorted(ends, probability, side="right")]

    def scores(self, words: np.ndarray[Any, Any]) -> Floats:
        """Return the scores (same shape) in the middle of those of each word."""
        shares = np.array(self.arguments()["weights"])
        middles = dict(zip(self.values, np.cumsum(shares) - shares / 2, strict=True))
        return np.asarray(scipy.special.ndtri([middles[word] for word in words]))

    def arguments(self) -> dict[str, Any]:
        """Return name, words and probabilities as lists, for the attributes of a dataset."""
        weights = self.weights or [1 / len(self.values)] * len(self.values)
        return {"distribution": CHOICE, "values": list(self.values), "weights": weights}


@dataclass(frozen=True)
class Fixed(Entry):
    """One value for all runs of a listed parameter, which is then not varied."""

    value: Annotated[Any, PlainValidator(read_value)]


CHOICE = Choice.name()
"""The name of the draw among words, which have no order and so no quantiles."""
_KINDS: list[type[Distribution]] = [*Distribution.__subclasses__(), Integers]
DISTRIBUTIONS: Mapping[str, type[Distribution]] = {kind.name(): kind for kind in _KINDS}
"""Distributions of numbers, by their names in study files."""
ENTRIES: Mapping[str, type[Entry]] = {**DISTRIBUTIONS, CHOICE: Choice, Fixed.name(): Fixed}


def distribution_of(attributes: Mapping[str, Any]) -> Distribution:
    """Return the distribution that the attributes of a coordinate hold, beside any others.

    Raises ValueError when the name is unknown or an argument is missing.
    """
    name = str(attributes.get("distribution"))
    if name not in DISTRIBUTIONS:
        raise ValueError(f"unknown distribution {name!r}: choose from {', '.join(DISTRIBUTIONS)}")
    kind: Any = DISTRIBUTIONS[name]
    keys = [field.name for field in fields(kind)]
    if absent := [key for key in keys if key not in attributes]:
        raise ValueError(f"a distribution {name!r} needs {', '.join(absent)}")
    distribution: Distribution = kind(*(float(attributes[key]) for key in keys))
    return distribution
