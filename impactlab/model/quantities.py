"""Quantities with units: from text to SI numbers, and amounts in words."""

from __future__ import annotations

import math
import re
from dataclasses import MISSING
from decimal import Decimal
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from pint import Unit, UnitRegistry

Quantity = Any
"""A number in SI units, a string with a unit ("27.8 mm"), or a quantity of pint."""

KINDS: dict[str, tuple[str, str]] = {
    "m": ("a length", "27.8 mm"),
    "m s-1": ("a velocity", "0.99 m/s"),
    "m s-2": ("an acceleration", "9.81 m/s2"),
    "kg": ("a mass", "1.4 kg"),
    "kg m-3": ("a density", "7.8 g/cm3"),
    "Pa": ("a stress", "345 MPa"),
    "s": ("a time", "12 ms"),
    "s-1": ("a rate", "40.4 s-1"),
    "N m-1": ("a stiffness", "2 kN/mm"),
    "N m-2": ("a stiffness per length", "5 N/mm2"),
    "N m": ("a rotational stiffness", "5 kN m"),
    "1": ("a pure number", "0.3"),
}
"""SI units (UDUNITS spelling), with the kind of quantity and an example."""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
_FACTOR = r"([^\W\d]+|°C|°F)(?:\*\*|\^)?(-?[1-9])?"
_TIMES = r"(?:\s*[*·]\s*(?!\*)|\s+)"
_PRODUCT = rf"{_FACTOR}(?:{_TIMES}{_FACTOR})*"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(%|{_PRODUCT}(?:\s*/\s*{_FACTOR})*)?")
_LONGEST = 80
_LONG = 0.1  # a duration in s that nobody means who gives no unit
_SUPERSCRIPTS = str.maketrans("⁻¹²³", "-123")


def si(value: object, units: str) -> float:
    """Return a number, a string such as "27.8 mm" or a pint quantity as a finite float in `units`.

    units: SI, in UDUNITS spelling ("kg m-3"), as in the tables of parameters and variables.
    Plain numbers are taken as SI. Strings are converted in decimal arithmetic, so that
    "27.8 mm" is 0.0278 to the last digit. One number and one unit are read, never an
    expression; each name in the unit is looked up by itself, in pint where UNITS lacks it.

    Raises ValueError when the value is no number, not finite, or of another dimension.
    """
    value, reason = as_text(value), "must be finite; "
    try:
        if isinstance(value, str):
            result = _parsed(value.strip(), units)
        elif isinstance(value, int | float | Real) and type(value) is not bool:
            result = float(value)
        else:
            result, reason = math.nan, ""
    except OverflowError:
        result = math.inf
    except ValueError as error:
        result, reason = math.nan, f"{error}; "
    if math.isfinite(result):
        return result
    kind, example = KINDS.get(units, (f"a quantity in {units}", f"1 {units}"))
    such = example if units == "1" else f"{example!r}, or a number in {symbol(units)}"
    raise ValueError(f"{reason}expected {kind} such as {such}")


def si_units(value: Any) -> str:
    """Return the SI units of a quantity given as text or by pint; "1" of anything else."""
    text = as_text(value)
    if not isinstance(text, str) or len(text) > _LONGEST:
        return "1"
    match = _QUANTITY.fullmatch(text.strip().translate(_SUPERSCRIPTS))
    if match is None or match[2] in (None, "%"):
        return "1"
    try:
        unit = _unit(match[2])
    except ValueError:
        return "1"
    for units in (*KINDS, *PREFIXED):
        if units not in ("1", "B") and _unit(units).dimensionality == unit.dimensionality:
            return units
    base = _registry().Quantity(1, unit).to_base_units().units
    powers = {
        _registry().get_symbol(name): int(float(str(power))) for name, power in base._units.items()
    }
    return " ".join(f"{name}{power if power != 1 else ''}" for name, power in powers.items()) or "1"


def as_text(value: Any) -> Any:
    """Return a quantity of pint as text with its unit, an array as a list; all else as it is."""
    if not (hasattr(value, "m") and hasattr(value, "u")):
        return value
    if hasattr(value.m, "__len__"):
        return [as_text(item) for item in value]
    unit = f"{value.u:~C}"
    return f"{float(value.m)!r} {unit}" if unit else float(value.m)


def in_si(name: str, value: Any, units: str) -> Any:
    """Return a string or a pint quantity as a float in `units`; anything else as it is.

    Raises ValueError as `si`, naming it.
    """
    if not isinstance(text := as_text(value), str):
        return text
    try:
        return si(text, units)
    except ValueError as error:
        raise ValueError(f"{name} = {text!r}: {error}") from None


T = TypeVar("T", float, float | None)


class SI(Generic[T]):
    """A field of a dataclass that takes quantities, and holds numbers in SI `units`.

    Raises ValueError naming the field, when it is set, for a unit of another dimension.
    """

    def __init__(self, units: str, default: Any = MISSING) -> None:
        """Note the units, and the default if any."""
        self._units, self._default = units, default

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, instance: Any, owner: type) -> T:
        """Return the number; of the class, the default, where dataclasses look for it."""
        if instance is None and self._default is MISSING:
            raise AttributeError(self._name)
        value: T = self._default if instance is None else instance.__dict__[self._name]
        return value

    def __set__(self, instance: Any, value: Quantity) -> None:
        """Set the number, once: dataclasses are frozen."""
        name = f"{type(instance).__name__}.{self._name}"
        instance.__dict__[self._name] = in_si(name, value, self._units)


def duration(value: object) -> float:
    """Return a simulated time in s. Raises ValueError as `si`, and for a long one without unit."""
    seconds = si(value, "s")
    if seconds >= _LONG and str(value).strip()[-1] in "0123456789.":
        raise ValueError(
            f"is in seconds without a unit, and impacts last milliseconds: write '{seconds:g} ms', "
            f"or '{seconds:g} s' if it is meant so"
        )
    return seconds


def whole(value: object) -> int:
    """Return a whole number, given as such or as a string. Raises ValueError otherwise."""
    try:
        result = si(value, "1")
    except ValueError:
        result = math.nan
    if not result.is_integer() or abs(result) > 2**53:
        raise ValueError("expected a whole number such as 201")
    return int(result)


def _parsed(text: str, units: str) -> float:
    match = _QUANTITY.fullmatch(text.translate(_SUPERSCRIPTS)) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError("cannot be read as one number and one unit")
    number, written = Decimal(match[1]), match[2]
    if written is None:
        return float(number)
    wrong = f"{written!r} has the wrong dimension"
    if written == "%" or units == "1":
        if written != "%" or units != "1":
            raise ValueError(wrong)
        return float(number / 100)
    unit, target = _scale(written), _scale(units)
    if unit is None or target is None:
        return _by_pint(number, written, units)
    if unit[1:] != target[1:]:
        raise ValueError(wrong)
    return float(number.scaleb(unit[0] - target[0]))


def _factors(written: str) -> list[tuple[str, int]]:
    """Return (name, power) of the factors before the first "/" and of those behind a "/"."""
    above, *below = written.split("/")
    return [
        (name, sign * int(power or 1))
        for sign, part in [(1, above), *((-1, part) for part in below)]
        for name, power in re.findall(_FACTOR, part)
    ]


def _by_pint(number: Decimal, written: str, units: str) -> float:
    unit, target = _unit(written), _unit(units)
    if unit.dimensionality != target.dimensionality:
        raise ValueError(f"{written!r} has the wrong dimension")
    return float(_registry().Quantity(number, unit).m_as(target))


def _unit(written: str) -> Unit:
    result = _registry().Unit("")
    for name, power in _factors(written):
        try:
            result *= _registry().parse_units(name) ** power
        except Exception:  # pint's parser raises many kinds, which all mean the same here
            raise ValueError(f"unknown unit {name!r}") from None
    return result


@cache
def _registry() -> UnitRegistry[Decimal]:
    """Return pint's units, in decimal arithmetic; loaded late, because that takes a second."""
    from pint import UnitRegistry

    return UnitRegistry(non_int_type=Decimal)


Scale = tuple[int, ...]
"""A unit as the powers of 10, metre, kilogram and second."""
UNITS: dict[str, Scale] = {
    "m": (0, 1, 0, 0),
    "cm": (-2, 1, 0, 0),
    "mm": (-3, 1, 0, 0),
    "um": (-6, 1, 0, 0),
    "µm": (-6, 1, 0, 0),
    "kg": (0, 0, 1, 0),
    "g": (-3, 0, 1, 0),
    "s": (0, 0, 0, 1),
    "ms": (-3, 0, 0, 1),
    "us": (-6, 0, 0, 1),
    "µs": (-6, 0, 0, 1),
    "Pa": (0, -1, 1, -2),
    "kPa": (3, -1, 1, -2),
    "MPa": (6, -1, 1, -2),
    "GPa": (9, -1, 1, -2),
    "N": (0, 1, 1, -2),
    "kN": (3, 1, 1, -2),
}
"""The units that studies mostly use, so that pint, slow to load, is rarely needed."""


def _scale(written: str) -> Scale | None:
    """Return the scale of a product of units; None where UNITS lacks one of them."""
    total: Scale = (0, 0, 0, 0)
    for name, power in _factors(written):
        if name not in UNITS:
            return None
        total = tuple(a + power * b for a, b in zip(total, UNITS[name], strict=True))
    return total


_PERIODS = {365.25 * 86400: "years", 86400: "days", 3600: "hours", 60: "minutes", 1: "s"}


def time(seconds: float) -> str:
    """Return a time with two digits in the largest unit that fits: 90 s is "1.5 minutes"."""
    for size, unit in _PERIODS.items():
        if seconds >= size:
            return f"{_two_digits(seconds / size)} {unit}"
    return f"{_two_digits(1e3 * seconds)} ms"


def engineering(value: float, units: str, digits: int = 4) -> str:
    """Return a quantity in SI units (UDUNITS) with a prefix: "97.52 µs"; a pure number as it is."""
    rounded, power = float(f"{value:.{digits}g}"), 0
    if rounded and math.isfinite(rounded) and units in PREFIXED:
        power = min(max(math.floor(math.log10(abs(rounded)) / 3), -3), 5)
    prefix = "nµm kMGTP"[power + 3].strip()
    return f"{float(f'{rounded / 1000.0**power:.{digits}g}'):,g} {prefix}{symbol(units)}".rstrip()


def symbol(units: str) -> str:
    """Return SI units as people write them: "m/s²" for "m s-2", "1/s" for "s-1"."""
    text = re.sub(r"(?:^| )(\w+)-(\d)", r"/\1\2", units).translate(str.maketrans("23", "²³", "1"))
    return f"1{text}" if text.startswith("/") else text


def shown(name: str, value: object, units: str) -> str:
    """Return a name and its value, in words or in SI `units`: "beam_depth = 27.8 mm"."""
    if isinstance(value, float) and units != "1":
        return f"{name} = {engineering(value, units, 6)}"
    return f"{name} = {value!r}"


_USUAL = {"m": ("mm",), "Pa": ("MPa", "GPa"), "kg m-3": ("g/cm3",)}
"""By SI units: those that people leave out."""


def misread(value: float, units: str, low: float, high: float) -> str:
    """Return a remark on a number that would lie from low to high in a usual unit; "" for others.

    All are in SI `units`. A number below 1 is taken to have been stated with its unit.
    """
    for usual in _USUAL.get(units, ()) if value >= 1 else ():
        if low <= si(f"{value:g} {usual}", units) <= high:
            read = f"{value:g} without a unit is read as {value:g} {symbol(units)}"
            return f"; {read}: write '{value:g} {usual}' if that is meant"
    return ""


PREFIXED = ("B", "J", "N", "N s", "Pa", "m", "s")
"""Units that a prefix fits."""


def amount(size: float) -> str:
    """Return an amount of bytes with two digits, in decimal units."""
    return engineering(size, "B", digits=2)


def _two_digits(number: float) -> str:
    return f"{float(f'{number:.2g}'):,g}"
