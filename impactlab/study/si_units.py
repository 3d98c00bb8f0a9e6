"""The units that studies mostly use: known here, so that pint, slow to load, need not be asked."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Scale(NamedTuple):
    """A unit as 10^ten m^metre kg^kilogram s^second."""

    ten: int = 0
    metre: int = 0
    kilogram: int = 0
    second: int = 0

    @property
    def dimension(self) -> tuple[int, int, int]:
        """The exponents of metre, kilogram and second."""
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
"""By name, as pint would have them."""


def scale(factors: Iterable[tuple[str, int]]) -> Scale | None:
    """The product of units, each to a power; None where a name is not of this table."""
    total = Scale()
    for name, power in factors:
        if name not in UNITS:
            return None
        total = Scale(*(sum_ + power * part for sum_, part in zip(total, UNITS[name], strict=True)))
    return total
