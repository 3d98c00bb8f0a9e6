"""Quantities with units: from text to SI numbers, and amounts in words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pint import Unit, UnitRegistry

KINDS: dict[str, tuple[str, str]] = {
    "m": ("a length", "27.8 mm"),
    "m s-1": ("a velocity", "0.99 m/s"),
    "m s-2": ("an acceleration", "9.81 m/s2"),
    "kg": ("a mass", "1.4 kg"),
    "kg m-3": ("a density", "7.8 g/cm3"),
    "Pa": ("a stress", "345 MPa"),
    "s": ("a time", "12 ms"),
    "1": ("a pure number", "0.3"),
}
"""SI units (UDUNITS spelling), with the kind of quantity and an example."""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
_FACTOR = r"([^\W\d]+|°C|°F)(?:\*\*|\^)?(-?[1-9])?"
_TIMES = r"(?:\s*[*·]\s*(?!\*)|\s+)"
_PRODUCT = rf"{_FACTOR}(?:{_TIMES}{_FACTOR})*"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(%|{_PRODUCT}(?:\s*/\s*{_FACTOR})*)?")
_LONGEST = 80
_SUPERSCRIPTS = str.maketrans("⁻¹²³", "-123")


def si(value: object, units: str) -> float:
    """Return a number or a string such as "27.8 mm" as a finite float in `units`.

    units: SI, in UDUNITS spelling ("kg m-3"), as in the tables of parameters and variables.
    Plain numbers are taken as SI. Strings are converted in decimal arithmetic, so that
    "27.8 mm" is 0.0278 to the last digit. One number and one unit are read, never an
    expression; each name in the unit is looked up by itself, in pint where UNITS lacks it.

    Raises ValueError when the value is no number, not finite, or of another dimension.
    """
    if isinstance(value, str):
        result = _parsed(value.strip(), units)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        result = _float(value)
    else:
        raise ValueError(expected(units))
    if not math.isfinite(result):
        raise ValueError(f"must be finite; {expected(units)}")
    return result


def whole(value: object) -> int:
    """Return a whole number, given as such or as a string. Raises ValueError otherwise."""
    try:
        result = si(value, "1")
    except ValueError:
        raise ValueError("expected a whole number such as 201") from None
    if not result.is_integer() or abs(result) > 2**53:
        raise ValueError("expected a whole number such as 201")
    return int(result)


def expected(units: str) -> str:
    """Return a sentence on the values that are valid for a quantity in these units."""
    kind, example = KINDS.get(units, (f"a quantity in {units}", f"1 {units}"))
    if units == "1":
        return f"expected {kind} such as {example}"
    return f"expected {kind} such as {example!r}, or a number in {units}"


def _float(value: int | float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _parsed(text: str, units: str) -> float:
    match = _QUANTITY.fullmatch(text.translate(_SUPERSCRIPTS)) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError(f"cannot be read as one number and one unit; {expected(units)}")
    number, written = Decimal(match[1]), match[2]
    if written is None:
        return float(number)
    if written == "%" or units == "1":
        return _percentage(number, written, units)
    unit, target = scale(_factors(written)), scale(_factors(units))
    if unit is None or target is None:
        return _by_pint(number, written, units)
    if unit.dimension != target.dimension:
        raise ValueError(f"{written!r} has the wrong dimension; {expected(units)}")
    return float(number.scaleb(unit.ten - target.ten))


def _percentage(number: Decimal, written: str, units: str) -> float:
    if written != "%" or units != "1":
        raise ValueError(f"{written!r} has the wrong dimension; {expected(units)}")
    return float(number / 100)


def _factors(written: str) -> list[tuple[str, int]]:
    """Return (name, power) of the factors before the first "/" and of those behind a "/"."""
    above, *below = written.split("/")
    return [
        (name, sign * int(power or 1))
        for sign, part in [(1, above), *((-1, part) for part in below)]
        for name, power in re.findall(_FACTOR, part)
    ]


def _by_pint(number: Decimal, written: str, units: str) -> float:
    unit, target = _unit(written, units), _unit(units, units)
    if unit.dimensionality != target.dimensionality:
        raise ValueError(f"{written!r} has the wrong dimension; {expected(units)}")
    return float(_registry().Quantity(number, unit).m_as(target))


def _unit(written: str, units: str) -> Unit:
    result = _registry().Unit("")
    for name, power in _factors(written):
        result *= _named(name, units) ** power
    return result


def _named(name: str, units: str) -> Unit:
    try:
        return _registry().parse_units(name)
    except Exception:  # pint's parser raises many kinds, which all mean the same here
        raise ValueError(f"unknown unit {name!r}; {expected(units)}") from None


@cache
def _registry() -> UnitRegistry[Decimal]:
    """Return pint's units, in decimal arithmetic; loaded late, because that takes a second."""
    from pint import UnitRegistry

    return UnitRegistry(non_int_type=Decimal)


class Scale(NamedTuple):
    """A unit as 10^ten m^metre kg^kilogram s^second."""

    ten: int = 0
    metre: int = 0
    kilogram: int = 0
    second: int = 0

    @property
    def dimension(self) -> tuple[int, int, int]:
        """Return the exponents of metre, kilogram and second."""
        return self[1:]


UNITS: dict[str, Scale] = {
    "m": Scale(metre=1),
    "cm": Scale(-2, metre=1),
    "mm": Scale(-3, metre=1),
    "um": Scale(-6, metre=1),
    "µm": Scale(-6, metre=1),
    "kg": Scale(kilogram=1),
    "g": Scale(-3, kilogram=1),
    "s": Scale(second=1),
    "ms": Scale(-3, second=1),
    "us": Scale(-6, second=1),
    "µs": Scale(-6, second=1),
    "Pa": Scale(metre=-1, kilogram=1, second=-2),
    "kPa": Scale(3, metre=-1, kilogram=1, second=-2),
    "MPa": Scale(6, metre=-1, kilogram=1, second=-2),
    "GPa": Scale(9, metre=-1, kilogram=1, second=-2),
}
"""The units that studies mostly use, so that pint, slow to load, is rarely needed."""


def scale(factors: Iterable[tuple[str, int]]) -> Scale | None:
    """Return the product of units, each to a power; None where UNITS lacks a name."""
    total = Scale()
    for name, power in factors:
        if name not in UNITS:
            return None
        total = Scale(*(sum_ + power * part for sum_, part in zip(total, UNITS[name], strict=True)))
    return total


_PERIODS = (
    (365.25 * 86400, "years"),
    (86400, "days"),
    (3600, "hours"),
    (60, "minutes"),
    (1, "s"),
)
_BYTES = ((1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


def time(seconds: float) -> str:
    """Return a time with two digits in the largest unit that fits: 90 s is "1.5 minutes"."""
    for size, unit in _PERIODS:
        if seconds >= size:
            return f"{_two_digits(seconds / size)} {unit}"
    return f"{_two_digits(1e3 * seconds)} ms"


def amount(size: float) -> str:
    """Return an amount of bytes with two digits, in decimal units."""
    for unit, name in _BYTES:
        if size >= unit:
            return f"{_two_digits(size / unit)} {name}"
    return f"{size:.0f} bytes"


def _two_digits(number: float) -> str:
    return f"{float(f'{number:.2g}'):,g}"
