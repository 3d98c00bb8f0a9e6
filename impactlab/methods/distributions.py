"""Distributions of varied parameters: sections of a study, and between values and probabilities.

A distribution is stored by name and arguments in SI units: the attributes of a varied coordinate of
runs.nc, whose other attributes do not matter here. A new one is a class here, and a line in
impactlab/__init__.pyi.
"""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, Self

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike
from pydantic import (
    Field,
    PlainValidator,
    StrictStr,
    TypeAdapter,
    ValidationInfo,
    field_validator,
    model_validator,
)

from impactlab.model.quantities import Quantity, engineering, whole
from impactlab.types import Floats
from impactlab.validation.fields import (
    LABEL,
    Number,
    Stated,
    Whole,
    at_key,
    quantity,
    requires,
    value_type,
)

_NEGLIGIBLE = 1e-40  # share of the draws beyond either end of a quadrature
_PANELS, _NODES = 40, 40  # of Gauss and Legendre


def _value(data: Any, info: ValidationInfo) -> Any:
    """Read a value that the parameter can take, in SI units."""
    kind = value_type(info.context["parameter"])  # type: ignore[index]
    return TypeAdapter(kind).validate_python(data)


def _whole_value(data: Any, info: ValidationInfo) -> int:
    """Read a whole number that the parameter can take, in SI units."""
    return whole(_value(data, info))


def _number(data: Any, info: ValidationInfo) -> float:
    """Read a number in the unit of the parameter, beyond its limits or not."""
    kind = quantity(info.context["parameter"].units)  # type: ignore[index]
    return float(TypeAdapter(kind).validate_python(data))


def _words(data: Any, info: ValidationInfo) -> tuple[str, ...]:
    parameter = info.context["parameter"]  # type: ignore[index]
    word: Any = value_type(parameter) if parameter.choices else Annotated[StrictStr, _LABELLED]
    return tuple(TypeAdapter(list[word]).validate_python(data))


_LABELLED = requires(
    lambda text: bool(LABEL.fullmatch(text)),
    "is no word: use letters, digits, _ and -, starting with a letter or a digit",
)
_ABOVE_ZERO = requires(lambda number: number > 0, "must be above 0")
Value = Annotated[Quantity, PlainValidator(_value)]
PositiveValue = Annotated[Quantity, PlainValidator(_value), _ABOVE_ZERO]
Centre = Annotated[Quantity, PlainValidator(_number)]
Positive = Annotated[Quantity, PlainValidator(_number), _ABOVE_ZERO]
_ABOVE_ONE = requires(
    lambda factor: factor > 1, "must be above 1 (with 1.1 most draws lie within 10 % of the median)"
)


class Entry(Stated):
    """The entry of a parameter in a sample: a distribution of numbers, words, or one value."""

    _name_key = "distribution"

    def arguments(self) -> dict[str, Any]:
        """Return name and arguments as in the study file, in SI units."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"distribution": self.name()} | values


class Distribution(Entry):
    """The distribution of a number.

    Raises ValueError unless low < high, with the mode between.
    """

    is_logarithmic: ClassVar[bool] = False
    """True where draws spread evenly, or normally, in their logarithm."""
    is_discrete: ClassVar[bool] = False
    """True where a value may be drawn more than once: no polynomials are fitted over it."""

    @abstractmethod
    def _frozen(self) -> Any:
        """Return scipy's distribution of these arguments."""

    @model_validator(mode="after")
    def _check_ends(self, info: ValidationInfo) -> Self:
        low, high, mode = (getattr(self, key, None) for key in ("low", "high", "mode"))
        if low is None or high is None:
            return self
        units = info.context["parameter"].units  # type: ignore[index]
        least, most = engineering(low, units), engineering(high, units)
        if high <= low:
            fixed = "; for a single value write {distribution: fixed, value: ...}"
            raise at_key("high", f"must be above low ({least}){fixed if high == low else ''}")
        if mode is not None and not low <= mode <= high:
            raise at_key("mode", f"must lie from low to high ({least} to {most})")
        return self

    def quantile(self, probability: ArrayLike) -> Floats:
        """Return the values (same shape) below which a draw lies with these probabilities.

        Never beyond `low` and `high`, which rounding may pass by a digit. Probabilities in [0, 1].
        """
        values = self._frozen().ppf(probability)
        low, high = getattr(self, "low", -np.inf), getattr(self, "high", np.inf)
        return np.asarray(np.clip(values, low, high))

    def at_scores(self, scores: ArrayLike) -> Floats:
        """Return the values (same shape) at standard normal scores, exact in both tails."""
        frozen, tail = self._frozen(), scipy.special.ndtr(-np.abs(scores))
        values = np.where(np.less(scores, 0), frozen.ppf(tail), frozen.isf(tail))
        low, high = getattr(self, "low", -np.inf), getattr(self, "high", np.inf)
        return np.asarray(np.clip(values, low, high))

    def cumulative(self, values: ArrayLike) -> Floats:
        """Return the probabilities (same shape) that a draw lies below these values."""
        return np.asarray(self._frozen().cdf(values))

    def quadrature(self) -> tuple[Floats, Floats]:
        """Return nodes (SI units) and weights, which add up to 1, of integrals over it.

        The nodes are logarithms of values where `is_logarithmic`. They integrate polynomials up to
        degree 40 to rounding.
        """
        frozen = self._frozen()
        low, high = float(frozen.ppf(_NEGLIGIBLE)), float(frozen.isf(_NEGLIGIBLE))
        if self.is_logarithmic:
            low, high = np.log(low), np.log(high)
        edges = np.linspace(low, high, _PANELS + 1)
        if isinstance(self, Triangular):  # whose density has a kink
            edges = np.unique([*edges, self.mode])
        half = np.diff(edges)[:, np.newaxis] / 2
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        x = (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel()
        density = frozen.pdf(np.exp(x)) * np.exp(x) if self.is_logarithmic else frozen.pdf(x)
        shares = (half * weights).ravel() * density
        return x, shares / shares.sum()

    def bounds(self) -> dict[str, float]:
        """Return the smallest and the largest draw, by key (low, high); empty when unbounded."""
        return {key: getattr(self, key) for key in ("low", "high") if hasattr(self, key)}


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
    geometric_standard_deviation: Annotated[Number, _ABOVE_ONE]
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
class Integers(Distribution):
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

    low: Annotated[Quantity, PlainValidator(_whole_value)]
    high: Annotated[Quantity, PlainValidator(_whole_value)]
    step: Annotated[Whole, Field(ge=1)] = 1
    is_discrete = True

    @field_validator("step")
    @classmethod
    def _check_step(cls, step: int, info: ValidationInfo) -> int:
        if {"low", "high"} <= info.data.keys() and (info.data["high"] - info.data["low"]) % step:
            raise ValueError("does not lead from low to high in whole steps")
        return step

    def _frozen(self) -> Any:
        """Return the distribution of the number of steps above `low`."""
        return scipy.stats.randint(0, (self.high - self.low) // self.step + 1)

    def quantile(self, probability: ArrayLike) -> Any:
        """Return the whole numbers (same shape) below or at which a draw lies at least so often."""
        return self.low + self.step * np.asarray(self._frozen().ppf(probability)).astype(np.int64)

    def at_scores(self, scores: ArrayLike) -> Any:
        """Return the whole numbers (same shape) at standard normal scores."""
        return self.quantile(scipy.special.ndtr(scores))

    def cumulative(self, values: ArrayLike) -> Floats:
        """Return the probabilities (same shape) that a draw lies at or below these values."""
        return np.asarray(self._frozen().cdf((np.asarray(values) - self.low) / self.step))


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

    values: Annotated[Sequence[str], PlainValidator(_words)]
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

    def arguments(self) -> dict[str, Any]:
        """Return name, words and probabilities as lists, for the attributes of a dataset."""
        weights = self.weights or [1 / len(self.values)] * len(self.values)
        return {"distribution": CHOICE, "values": list(self.values), "weights": weights}


@dataclass(frozen=True)
class Fixed(Entry):
    """One value for all runs of a listed parameter, which is then not varied."""

    value: Annotated[Any, PlainValidator(_value)]


CHOICE = Choice.name()
"""The name of the draw among words, which have no order and so no quantiles."""
DISTRIBUTIONS: Mapping[str, type[Distribution]] = {
    kind.name(): kind for kind in Distribution.__subclasses__()
}
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
