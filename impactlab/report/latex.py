"""Tables in LaTeX, with the names, units and digits of the figures, for booktabs and siunitx."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.types import Floats

_PREAMBLE = r"% Needs \usepackage{booktabs,longtable,siunitx}" + "\n"
_PLAIN = (1e-3, 1e6)  # magnitudes that are written without a power of ten
_SHARE = 0.01  # largest size from which pure numbers have three decimals
_WIDTH = 14  # letters of a line of a head
_WIDTHS = {60: r"0.9\linewidth", 20: "10em"}  # by letters, of texts that break into lines
_RAGGED = r">{\raggedright\arraybackslash}"
_MISSING = "{--}"
_ESCAPES = str.maketrans(
    {letter: rf"\{letter}" for letter in "&%$#_{}"}
    | {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
    | {"<": r"\textless{}", ">": r"\textgreater{}", "\N{NO-BREAK SPACE}": "~"}
    | {"−": "$-$", "×": r"$\times$", "±": r"$\pm$", "∞": r"$\infty$", "≥": r"$\geq$"}
    | {"⁻⁰¹²³⁴⁵⁶⁷⁸⁹"[n]: rf"\textsuperscript{{{'-0123456789'[n]}}}" for n in range(11)}
    | {"ρ": r"$\rho$", "σ": r"$\sigma$", "µ": r"\textmu{}"}
)


def write_latex(
    table: Mapping[str, xr.DataArray], path: Path, caption: str, study: str, name: str
) -> None:
    """Write a table that breaks across pages, labelled `tab:STUDY-NAME`.

    table: columns in SI units by name, each with its `label` and, of words, perhaps their `names`.
    """
    import pandas as pd

    arrays = xr.broadcast(*table.values())
    named = [array.rename(key) for key, array in zip(table, arrays, strict=True)]
    cells, heads, formats = zip(*map(_column, named), strict=True)
    frame = pd.DataFrame(dict(enumerate(cells)))
    text = (
        frame.style.hide(axis="index")
        .format_index(heads.__getitem__, axis="columns")
        .to_latex(
            environment="longtable",
            column_format="".join(formats),
            hrules=True,
            siunitx=True,  # heads of columns of numbers stand in braces
            caption=escaped(caption),
            label=f"tab:{study}-{name}",
        )
    )
    path.write_text(f"{_PREAMBLE}\\begingroup\\small\n{text}\\endgroup\n", encoding="utf-8")


def escaped(text: str) -> str:
    """Return a text as LaTeX prints it."""
    return text.translate(_ESCAPES)


def _column(array: xr.DataArray) -> tuple[list[str], str, str]:
    """Return the cells of a column, its head and its format."""
    label, flat = str(array.attrs["label"]), range(array.size)
    if array.dtype.kind not in "if":
        names = array.attrs.get("names", {})
        texts = labels.values(array, flat, short=True)
        cells = [
            escaped(names.get(str(value), text))
            for value, text in zip(array.values.flat, texts, strict=True)
        ]
        longest = max(map(len, cells), default=0)
        width = next((width for least, width in _WIDTHS.items() if longest > least), "")
        return cells, _head(label), rf"{_RAGGED}p{{{width}}}" if width else "l"
    display = labels.display(array)
    cells = _numbers(display(array.values.ravel()), pure=not display.symbol)
    return cells, _head(label, _unit(display.symbol)), f"S[table-format={_shape(cells)}]"


def _head(label: str, unit: str = "") -> str:
    """Return a head of short lines, its unit in the last."""
    lines = [escaped(line) for line in textwrap.wrap(label, _WIDTH, break_long_words=False)]
    if unit:
        lines.append(rf"(\unit{{{unit}}})")
    return r"\shortstack{" + r"\\".join(lines) + "}" if len(lines) > 1 else "".join(lines)


def _unit(symbol: str) -> str:
    """Return a unit as siunitx reads it: "m/s^{2}" for "m/s²"."""
    plain = symbol.translate(str.maketrans("²³", "23"))
    raised = re.sub(r"(?<=[a-zA-Z])(-?\d+)", r"^{\1}", plain)
    return raised.replace(" ", ".").replace("%", r"\percent").replace("µ", r"\micro ")


def _numbers(values: Floats, *, pure: bool) -> list[str]:
    """Return numbers of four digits, pure ones (shares, counts) of three decimals or none.

    All have a power of ten where one of them needs it.
    """
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    least, largest = sizes.min(initial=1.0), sizes.max(initial=0.0)
    if (sizes == np.round(sizes)).all() and largest < _PLAIN[1]:
        texts = [f"{value:.0f}" for value in values]
    elif pure and largest >= _SHARE:
        texts = [f"{value:.3f}" for value in values]
    elif _PLAIN[0] <= least and largest < _PLAIN[1]:
        exact = all(float(f"{value:.4g}") == value for value in values[np.isfinite(values)])
        texts = [f"{value:.4g}" if exact else f"{value:#.4g}".rstrip(".") for value in values]
        texts = [f"{float(text):.0f}" if "e" in text else text for text in texts]
    else:
        texts = [f"{value:.3e}" for value in values]
    finite = np.isfinite(values).tolist()
    return [text if given else _MISSING for text, given in zip(texts, finite, strict=True)]


def _shape(cells: list[str]) -> str:
    """Return the sign and the digits that a column of numbers needs, as siunitx writes them."""
    parts = [re.fullmatch(r"(-?)(\d+)\.?(\d*)(?:e([+-])(\d+))?", cell) for cell in cells]
    numbers = [part.groups(default="") for part in parts if part]
    if not numbers:
        return "1.0"
    sign = "-" if any(negative for negative, *_ in numbers) else ""
    digits = [max(len(number[place]) for number in numbers) for place in (1, 2, 4)]
    power = f"e-{digits[2]}" if digits[2] else ""
    return f"{sign}{digits[0]}.{digits[1]}{power}"
