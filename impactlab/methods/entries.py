"""Base classes of what a parameter of a sample may be: entries, and distributions of numbers."""

from abc import abstractmethod
from dataclasses import fields
from typing import Annotated, Any, ClassVar, Self

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike
from pydantic import PlainValidator, StrictStr, TypeAdapter, ValidationInfo, model_validator

from impactlab.model.quantities import Quantity, engineering, whole
from impactlab.types import Floats
from impactlab.validation.fields import LABEL, Stated, at_key, quantity, requires, value_type

_NEGLIGIBLE = 1e-40  # share of the draws beyond either end of a quadrature
_PANELS, _NODES = 40, 40  # of Gauss and Legendre


def read_value(data: Any, info: ValidationInfo) -> Any:
    """Read a value that the parameter can take, in SI units."""
    kind = value_type(info.context["parameter"])  # type: ignore[index]
    return TypeAdapter(kind).validate_python(data)


def read_whole(data: Any, info: ValidationInfo) -> int:
    """Read a whole number that the parameter can take, in SI units."""
    return whole(read_value(data, info))


def _number(data: Any, info: ValidationInfo) -> float:
    """Read a number in the unit of the parameter, beyond its limits or not."""
    kind = quantity(info.context["parameter"].units)  # type: ignore[index]
    return float(TypeAdapter(kind).validate_python(data))


def read_words(data: Any, info: ValidationInfo) -> tuple[str, ...]:
    """Read the words among which a parameter is drawn."""
    parameter = info.context["parameter"]  # type: ignore[index]
    word: Any = value_type(parameter) if parameter.choices else Annotated[StrictStr, _LABELLED]
    return tuple(TypeAdapter(list[word]).validate_python(data))


_LABELLED = requires(
    lambda text: bool(LABEL.fullmatch(text)),
    "is no word: use letters, digits, _ and -, starting with a letter or a digit",
)
_ABOVE_ZERO = requires(lambda number: number > 0, "must be above 0")
Value = Annotated[Quantity, PlainValidator(read_value)]
PositiveValue = Annotated[Quantity, PlainValidator(read_value), _ABOVE_ZERO]
Centre = Annotated[Quantity, PlainValidator(_number)]
Positive = Annotated[Quantity, PlainValidator(_number), _ABOVE_ZERO]
ABOVE_ONE = requires(
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

    def scores(self, values: ArrayLike) -> Floats:
        """Return the standard normal scores (same shape) of values, exact in both tails."""
        frozen = self._frozen()
        below, above = frozen.cdf(values), frozen.sf(values)
        lower, upper = scipy.special.ndtri(below), -scipy.special.ndtri(above)
        return np.asarray(np.where(below < above, lower, upper))

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
        if (mode := getattr(self, "mode", None)) is not None:  # where the density has a kink
            edges = np.unique([*edges, mode])
        half = np.diff(edges)[:, np.newaxis] / 2
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        x = (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel()
        density = frozen.pdf(np.exp(x)) * np.exp(x) if self.is_logarithmic else frozen.pdf(x)
        shares = (half * weights).ravel() * density
        return x, shares / shares.sum()

    def bounds(self) -> dict[str, float]:
        """Return the smallest and the largest draw, by key (low, high); empty when unbounded."""
        return {key: getattr(self, key) for key in ("low", "high") if hasattr(self, key)}
