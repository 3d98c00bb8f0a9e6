"""The figures of a study inside the page, each with the numbers behind it."""

from __future__ import annotations

import base64
import csv
import json
import math
import re
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from impactlab.figures import labels
from impactlab.figures.draw import CAPTIONS
from impactlab.report.page import Cell, Table

_SCREEN = 1.3
"""Figures are 8 pt at the width of a paper; on a screen that is small."""
_FILES = {".csv": "CSV", ".nc": "netCDF", ".svg": "SVG", ".png": "PNG"}
_MOST = 80
"""Largest number of curve points in a table; bars with names are all listed."""
_KEYS = {
    "panel": "Panel",
    "curve": "Curve",
    "category": "Of",
    "x_label": "Horizontal axis (x)",
    "y_label": "Vertical axis (y)",
}


@dataclass(frozen=True)
class Picture:
    """A numbered figure.

    alt: what it shows, in words. uri: the whole SVG as a data URI. width: on a screen, in CSS
    pixels. data: its numbers, thinned; None for maps. files: (kind, name) of those in its folder.
    """

    number: int
    name: str
    title: str
    caption: str
    alt: str
    uri: str
    width: int
    data: Table | None
    files: list[tuple[str, str]]


def pictures(folder: Path) -> list[Picture]:
    """Return the figures that captions.json lists, in its order.

    Raises FileNotFoundError, saying what to do, when it or a figure is not in the folder.
    """
    captions = json.loads(_read(folder / CAPTIONS))
    return [
        _picture(number, folder / f"{name}.svg", entry)
        for number, (name, entry) in enumerate(captions.items(), 1)
    ]


def drawn_data(path: Path) -> Table:
    """Return one row per point: panel, curve, category and numbers; curves are thinned evenly.

    path: NAME.csv as written by figures/data.py. Raises OSError where it cannot be read.
    """
    with path.open(encoding="utf-8", newline="") as file:
        points = list(csv.DictReader(file))
    named = any(row["category"] for row in points)
    shown = points if named else _thinned(points)
    keys, axes = _keys(shown), ["x"] if named else ["x", "y"]
    head = [_KEYS[key] for key in keys] + [_head(shown, axis) for axis in axes]
    rows = [_cells(row, keys, axes) for row in shown]
    part = "" if len(shown) == len(points) else f" ({len(shown)} of {len(points)} points)"
    return Table(f"Data as drawn{part}", head, rows)


def _picture(number: int, path: Path, entry: dict[str, str]) -> Picture:
    """Return a figure as an image of its own, so that names inside SVGs cannot clash."""
    svg, numbers = _read(path), path.with_suffix(".csv")
    return Picture(
        number,
        path.stem,
        entry["title"],
        entry["caption"],
        f"{entry['title']}. {entry['alt']}".strip(),
        f"data:image/svg+xml;base64,{base64.b64encode(svg).decode('ascii')}",
        _width(svg),
        drawn_data(numbers) if numbers.exists() else None,
        [(kind, f"{path.stem}{suffix}") for suffix, kind in _FILES.items()],
    )


def _width(svg: bytes) -> int:
    """Return the width on a screen, from the points that matplotlib writes in the root element."""
    found = re.search(rb'<svg [^>]*?\bwidth="([\d.]+)pt"', svg)
    points = float(found.group(1)) if found else 0.0
    return round(points * 96 / 72 * _SCREEN)


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path} is missing: draw the figures again (impactlab figures)"
        ) from None


def _thinned(points: list[dict[str, str]]) -> list[dict[str, str]]:
    """Return points of each curve at even steps, the first included."""
    step = math.ceil(len(points) / _MOST)
    curves = groupby(points, key=lambda row: (row["panel"], row["curve"]))
    return [row for _, curve in curves for row in list(curve)[::step]]


def _keys(rows: list[dict[str, str]]) -> list[str]:
    """Return the columns that distinguish the points; axis labels only where they differ."""
    given = [key for key in ("panel", "curve", "category") if any(row[key] for row in rows)]
    differ = [key for key in ("x_label", "y_label") if len({row[key] for row in rows}) > 1]
    return given + differ


def _head(rows: list[dict[str, str]], axis: str) -> str:
    """Return the axis's label where all panels share it, else its letter."""
    texts = {row[f"{axis}_label"] for row in rows}
    return texts.pop() or axis if len(texts) == 1 else axis


def _cells(row: dict[str, str], keys: list[str], axes: list[str]) -> list[Cell]:
    numbers = [Cell(labels.number(float(row[axis])), "number") for axis in axes]
    return [*(Cell(row[key] or "–") for key in keys), *numbers]
