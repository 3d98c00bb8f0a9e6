"""Labels of a dataset's variables, values and units, as papers print them.

Force is shown in kN, time in ms, lengths in mm or µm, strain in %.
"""

import math
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from impactlab import wings
from impactlab.methods import METHODS
from impactlab.methods.distributions import CHOICE
from impactlab.solver.contact import CONTACT_LAWS, LawRecord
from impactlab.types import Floats
from impactlab.variables import of_function

_STEPS: dict[str, tuple[tuple[float, float, str], ...]] = {
    "N": ((100.0, 1e-3, "kN"), (0.0, 1.0, "N")),
    "s": ((1e-4, 1e3, "ms"), (0.0, 1e6, "µs")),
    "m": ((1e-3, 1e3, "mm"), (0.0, 1e6, "µm")),
    "Pa": ((1e10, 1e-9, "GPa"), (0.0, 1e-6, "MPa")),
    "J": ((0.1, 1.0, "J"), (0.0, 1e3, "mJ")),
    "m s-1": ((0.0, 1.0, "m/s"),),
    "m s-2": ((0.0, 1.0, "m/s²"),),
    "m-1": ((0.0, 1.0, "1/m"),),
    "s-1": ((0.0, 1.0, "1/s"),),
    "N m": ((1e3, 1e-3, "kN m"), (0.0, 1.0, "N m")),
    "kg m-3": ((0.0, 1.0, "kg/m³"),),
    "1": ((0.0, 1.0, ""),),
}
"""By `units` attribute: (smallest magnitude, factor from SI, symbol), the largest step first."""
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_RULES = {"lobatto": "Gauss-Lobatto", "legendre": "Gauss-Legendre", "layers": "uniform layers"}


@dataclass(frozen=True)
class Display:
    """A display unit: SI values times `scale` are in the unit `symbol` ("" for pure numbers)."""

    scale: float
    symbol: str

    def __call__(self, values: ArrayLike) -> Floats:
        """Return SI values in the display unit, in the same shape."""
        return np.asarray(values, dtype=float) * self.scale


def display(array: xr.DataArray) -> Display:
    """Return the display unit of a variable, by its `units` attribute and largest magnitude.

    A plastic strain is shown in %; a unit that is not in the table is shown as it is stored.
    """
    units = str(array.attrs.get("units", "1"))
    if "plastic_strain" in str(array.name) and units == "1" and not of_function(array):
        return Display(100.0, "%")
    numbers = array.data if array.dtype.kind in "if" and array.size else np.zeros(1)
    largest = float(np.where(np.isfinite(numbers), np.abs(numbers), 0.0).max())  # also of dask's
    steps = _STEPS.get(units, ((0.0, 1.0, units),))
    return next(Display(scale, symbol) for least, scale, symbol in steps if largest >= least)


def response(name: str) -> str:
    """Return a response's name in words: "peak force"."""
    return name.replace("_", " ")


def title(name: str) -> str:
    """Return a response's name in words, with a capital first letter: "Peak force"."""
    return sentence(response(name))


def beam_model(name: str) -> str:
    """Return the proper name of a model of the beam: "Euler-Bernoulli"."""
    further = wings.models().get(name)
    return further.label if further else "-".join(map(str.capitalize, name.split("_")))


def parameter(coordinate: xr.DataArray) -> str:
    """Return a parameter's meaning: "yield stress of the beam"."""
    return str(coordinate.attrs.get("long_name") or response(str(coordinate.name)))


def method(name: str) -> str:
    """Return the name of a sampling method in words: "grid", "Sobol sample"."""
    return METHODS[name].label if name in METHODS else name


def sentence(text: str) -> str:
    """Return the text with a capital first letter."""
    return text[:1].upper() + text[1:]


def axis(text: str, symbol: str) -> str:
    """Return an axis label with its unit: "Peak force (kN)"; a pure number has the unit "–"."""
    return f"{sentence(text)} ({symbol or '–'})"


def wrapped_axis(text: str, symbol: str, width: int = 30) -> str:
    """Return an axis label in lines of at most `width` letters, for panels side by side."""
    return textwrap.fill(axis(text, symbol), width, break_long_words=False)


def number(value: float, digits: int = 4, plain: tuple[float, float] = (1e-4, 1e5)) -> str:
    """Return a number to `digits` significant digits: "−0.0125", "3.1×10⁻⁶"; NaN is "missing".

    plain: range of magnitudes, the upper end excluded, that are written without a power of ten.
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


def percent(share: float, digits: int = 2) -> str:
    """Return a share in per cent: "1.5 %"; NaN is a dash, infinity "no bound"."""
    if math.isinf(share):
        return "no bound"
    return "–" if math.isnan(share) else f"{number(100 * share, digits)} %"


def signed(share: float) -> str:
    """Return a relative change in per cent with its sign: "+1.5 %"."""
    text = f"{number(100.0 * share, 2)} %"
    return text if share < 0 else f"+{text}"


def counted(number: int, noun: str) -> str:
    """Return a number of things: "1 check", "1,024 checks"."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def listing(items: Sequence[str]) -> str:
    """Return the items as a list in words: "a, b and c"."""
    return " and ".join(filter(None, (", ".join(items[:-1]), *items[-1:])))


def span(values: Floats, digits: int) -> str:
    """Return the range of some values, "2 to 19", or the one value that all of them have."""
    low, high = number(float(values.min()), digits), number(float(values.max()), digits)
    return low if low == high else f"{low} to {high}"


def values(coordinate: xr.DataArray, where: Iterable[int], *, short: bool = False) -> list[str]:
    """Return the values at these positions as text, in the display unit, without its symbol.

    Words of study files are spelt as in papers; contact laws have their titles, or short names.
    """
    if coordinate.dtype.kind in "if":
        shown = np.ravel(display(coordinate)(coordinate.values))
        return [number(float(shown[position])) for position in where]
    words = [str(coordinate.values.flat[position]) for position in where]
    return [_spelled(coordinate, word, short=short) for word in words]


def _spelled(coordinate: xr.DataArray, word: str, *, short: bool = False) -> str:
    name = "" if of_function(coordinate) else coordinate.name
    if name == "contact":
        law = CONTACT_LAWS.get(word, LawRecord(name=word, short=word, title=word))
        return law.short if short else law.title
    if name == "beam_model":
        return beam_model(word)
    return _RULES[word] if name == "rule" else word.replace("_", " ")


def words(coordinate: xr.DataArray) -> list[str]:
    """Return the words that a parameter is drawn among, for axes and tables; [] for numbers."""
    if coordinate.attrs.get("distribution") != CHOICE:
        return []
    listed = np.atleast_1d(coordinate.attrs["values"])
    return [_spelled(coordinate, str(word), short=True) for word in listed]


def unit(coordinate: xr.DataArray) -> str:
    """Return a space and the symbol of the display unit, "" for pure numbers and words."""
    symbol = display(coordinate).symbol
    return f" {symbol}" if symbol else ""


def amount(variable: xr.DataArray, value: float, digits: int = 4) -> str:
    """Return an SI value in the display unit of a variable: "12.3 kN"."""
    return number(float(display(variable)(value)), digits) + unit(variable)


def value(coordinate: xr.DataArray, position: int) -> str:
    """Return one value with its unit, or with the name of what it counts: "5 m/s", "601 nodes"."""
    name, text = str(coordinate.name), values(coordinate, [position])[0]
    if name == "run":
        return f"run {text}"
    counted = name in ("nodes", "points") and not of_function(coordinate)
    return f"{text} {name}" if counted else text + unit(coordinate)


def brief(coordinate: xr.DataArray, position: int) -> str:
    """Return one value with its unit, as `value`, or the short name of a word."""
    if coordinate.dtype.kind in "if":
        return value(coordinate, position)
    return values(coordinate, [position], short=True)[0]


def setting(coordinate: xr.DataArray, where: Iterable[int]) -> str:
    """Return a parameter with some of its values: "impact velocity = 1, 5 and 20 m/s"."""
    texts = values(coordinate, where)
    if any(", " in text for text in texts):
        texts = [f"“{text}”" for text in texts]
    listed = listing(texts)
    return f"{parameter(coordinate)} = {listed}{unit(coordinate)}"
