"""The numbers behind a figure, few enough to read, from the CSV file beside it."""

from __future__ import annotations

import csv
import math
from itertools import groupby
from pathlib import Path

from impactlab.figures import labels
from impactlab.report.table import Cell, Table

_MOST = 80
"""Points of curves in a table; bars of named things are all told."""
_KEYS = {
    "panel": "Panel",
    "curve": "Curve",
    "category": "Of",
    "x_label": "Horizontal axis (x)",
    "y_label": "Vertical axis (y)",
}
Row = dict[str, str]


def drawn_data(path: Path) -> Table:
    """A row a point: panel, curve, what it is of, and its numbers; curves evenly thinned.

    path: NAME.csv as written by figures/data.py. Raises OSError where it cannot be read.
    """
    with path.open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    named = any(row["category"] for row in found)
    shown = found if named else _thinned(found)
    keys, axes = _keys(shown), ["x"] if named else ["x", "y"]
    head = [_KEYS[key] for key in keys] + [_head(shown, axis) for axis in axes]
    rows = [_cells(row, keys, axes) for row in shown]
    part = "" if len(shown) == len(found) else f" ({len(shown)} of {len(found)} points)"
    return Table(f"Data as drawn{part}", head, rows)


def _thinned(found: list[Row]) -> list[Row]:
    """Points of each curve at even steps, its first among them."""
    step = math.ceil(len(found) / _MOST)
    curves = groupby(found, key=lambda row: (row["panel"], row["curve"]))
    return [row for _, points in curves for row in list(points)[::step]]


def _keys(rows: list[Row]) -> list[str]:
    """The columns that tell the points apart: labels of axes where they differ."""
    given = [key for key in ("panel", "curve", "category") if any(row[key] for row in rows)]
    differ = [key for key in ("x_label", "y_label") if len({row[key] for row in rows}) > 1]
    return given + differ


def _head(rows: list[Row], axis: str) -> str:
    """The axis's label where all panels share it, else its letter."""
    texts = {row[f"{axis}_label"] for row in rows}
    return texts.pop() or axis if len(texts) == 1 else axis


def _cells(row: Row, keys: list[str], axes: list[str]) -> list[Cell]:
    numbers = [Cell(labels.number(float(row[axis])), "number") for axis in axes]
    return [*(Cell(row[key] or "–") for key in keys), *numbers]
