"""Comparisons as tables: ours, the independent value, the difference and what is allowed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.labels import Display, display
from impactlab.report.table import Cell, Table
from impactlab.verification.finding import Comparison

_HEAD = [
    "Quantity",
    "Case",
    "Ours",
    "Independent value",
    "Difference",
    "Tolerance",
    "Verdict",
]
_DIGITS = 6
_PLAIN = ("absolute", "relative")
"""Measures that show by themselves: a unit, or none."""
_PERCENT = 1e-4
"""Tolerances from here on are told in %."""


def table(caption: str, comparisons: Sequence[Comparison]) -> Table:
    """A row a comparison, in the order given."""
    return Table(caption, _HEAD, [_row(entry) for entry in comparisons])


def _row(entry: Comparison) -> list[Cell]:
    unit = _display(entry, max(abs(entry.ours), abs(entry.independent)))
    error, tolerance = _gap(entry)
    return [
        Cell(labels.sentence(entry.quantity)),
        Cell(entry.where),
        Cell(_value(entry.ours, unit, _DIGITS), "number"),
        Cell(_value(entry.independent, unit, _DIGITS), "number"),
        Cell(error, "number", "" if entry.measure in _PLAIN else entry.measure),
        Cell(tolerance, "number"),
        Cell("passed") if entry.passed else Cell("FAILED", "warning"),
    ]


def _gap(entry: Comparison) -> tuple[str, str]:
    """Error and tolerance as text, in the same unit."""
    if entry.measure == "absolute":
        unit = _display(entry, entry.tolerance)
    else:
        unit = Display(100.0, "%") if entry.tolerance >= _PERCENT else Display(1.0, "")
    return _value(entry.error, unit, 2), _value(entry.tolerance, unit, 2)


def _value(value: float, unit: Display, digits: int) -> str:
    text = labels.number(float(unit(value)), digits)
    return f"{text} {unit.symbol}".strip() if np.isfinite(value) else text


def _display(entry: Comparison, magnitude: float) -> Display:
    name = entry.quantity.replace(" ", "_")
    return display(xr.DataArray([magnitude], attrs={"units": entry.units}, name=name))
