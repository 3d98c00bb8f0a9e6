"""Names, values and lists of a dataset in plain words."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from impactlab.figures.reading.units import display
from impactlab.model.parameters import PARAMETERS

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SPELLED = {
    "lobatto": "Gauss-Lobatto",
    "legendre": "Gauss-Legendre",
    "layers": "uniform layers",
    "semi_implicit": "semi-implicit",
}
_METHODS = {
    "sobol": "Sobol sample",
    "morris": "Morris trajectories",
    "fast": "extended FAST curves",
    "delta": "Latin hypercube for delta indices",
    "pawn": "Latin hypercube for PAWN indices",
    "regression": "Latin hypercube for regression",
}
_NAMES = {"mjg": "MJG", "stronge_original": "Stronge (original)"}


def response(name: str) -> str:
    """A response's name in words: "peak force"."""
    return name.replace("_", " ")


def parameter(name: str) -> str:
    """A parameter's meaning: "yield stress of the beam"."""
    return PARAMETERS[name].long_name if name in PARAMETERS else name.replace("_", " ")


def method(name: str) -> str:
    """How the runs were chosen: "grid", "Sobol sample"."""
    return _METHODS.get(name, name)


def sentence(text: str) -> str:
    """The text with its first letter raised."""
    return text[:1].upper() + text[1:]


def axis(text: str, symbol: str) -> str:
    """An axis label with its unit: "Peak force (kN)"; a pure number has the unit "–"."""
    return f"{sentence(text)} ({symbol or '–'})"


def wrapped_axis(text: str, symbol: str, width: int = 30) -> str:
    """An axis label in lines of about so many letters, for panels side by side."""
    return textwrap.fill(axis(text, symbol), width, break_long_words=False)


def number(value: float, digits: int = 4, plain: tuple[float, float] = (1e-4, 1e5)) -> str:
    """A number to `digits` significant digits, typeset: "−0.0125", "3.1×10⁻⁶"; NaN: "missing".

    plain: from and below which magnitude it is written without a power of ten.
    """
    if math.isnan(value):
        return "missing"
    rounded = float(f"{value:.{digits}g}")
    if rounded == 0 or plain[0] <= abs(rounded) < plain[1] or math.isinf(rounded):
        text = np.format_float_positional(rounded, trim="-")
    else:
        text = np.format_float_scientific(rounded, trim="-")
    mantissa, _, exponent = text.partition("e")
    text = mantissa.replace("-", "−").replace("inf", "∞")
    if not exponent:
        return text
    power = f"10{str(int(exponent)).translate(_RAISED)}"
    return power if text == "1" else f"{text}×{power}"


def counted(number: int, what: str) -> str:
    """A number of things: "1 check", "1,024 checks"."""
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"


def listing(items: Sequence[str]) -> str:
    """The items in a row: "a, b and c"."""
    return " and ".join(filter(None, (", ".join(items[:-1]), *items[-1:])))


def values(coordinate: xr.DataArray, where: Iterable[int]) -> list[str]:
    """The values at these positions as text, in the coordinate's display unit, without it."""
    if coordinate.dtype.kind not in "if":
        return [_name(str(coordinate.name), str(coordinate.values[at])) for at in where]
    shown = display(coordinate)(coordinate.values)
    return [number(float(shown[at])) for at in where]


def _name(parameter: str, value: str) -> str:
    """A word of a study file as papers spell it; laws and beam models are named for people."""
    if parameter in ("contact", "beam_model"):
        return _NAMES.get(value) or "-".join(part.capitalize() for part in value.split("_"))
    return _SPELLED.get(value, value.replace("_", " "))


def unit(coordinate: xr.DataArray) -> str:
    """A space and the display unit, or nothing for pure numbers and words."""
    symbol = display(coordinate).symbol
    return f" {symbol}" if symbol else ""


def value(coordinate: xr.DataArray, at: int) -> str:
    """One value with its unit, or with the name of what is counted: "5 m/s", "601 nodes"."""
    name, text = str(coordinate.name), values(coordinate, [at])[0]
    if name == "run":
        return f"run {text}"
    counted = name in PARAMETERS and PARAMETERS[name].whole
    return f"{text} {name}" if counted else text + unit(coordinate)


def setting(coordinate: xr.DataArray, where: Iterable[int]) -> str:
    """A parameter with one or several of its values: "impact velocity = 1, 5 and 20 m/s"."""
    listed = listing(values(coordinate, where))
    return f"{parameter(str(coordinate.name))} = {listed}{unit(coordinate)}"
