"""Alternative texts of figures: a few sentences from the data as drawn."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import data, labels
from impactlab.figures.data import Drawn

_PANELS, _CURVES = 5, 3
"""Largest numbers of panels, and of curves per panel, that are described one by one."""


def alt(figure: Figure) -> str:
    """Return a sentence per panel: where its bars are longest, or the ranges of its curves."""
    curves = list(data.drawn(figure))
    described = [
        *_drawn(curves),
        *_maps(figure),
        *_meshes(figure),
        *_remarks(figure, {one.panel for one in curves}),
    ]
    shown = " ".join(described[:_PANELS])
    more = len(described) - _PANELS
    return f"{shown} And {labels.counted(more, 'more panel')}." if more > 0 else shown


def _drawn(curves: list[Drawn]) -> Iterator[str]:
    for panel, group in groupby(curves, key=lambda curve: curve.panel):
        found = list(group)
        name = panel if not panel.startswith("panel ") else _axes(found[0])
        yield f"{name}: {_curves(found)}."


def _axes(curve: Drawn) -> str:
    return " against ".join(filter(None, (curve.y_label, curve.x_label)))


def _curves(found: list[Drawn]) -> str:
    if len(found) <= _CURVES or any(found[0].category):
        return "; ".join(map(_curve, found))
    highest = max(found, key=lambda curve: float(curve.y.max()))
    return f"highest of {len(found)}: {_curve(highest)}"


def _curve(curve: Drawn) -> str:
    label = f"{curve.curve}: " if curve.curve else ""
    if any(curve.category):
        at = int(np.argmax(np.abs(curve.x)))
        return f"{label}largest for {curve.category[at]} ({_number(curve.x[at])})"
    if curve.x.size == 1:
        return f"{label}{_number(curve.x[0])}, {_number(curve.y[0])}"
    return f"{label}{_range(curve.y)} over {_range(curve.x)}"


def _maps(figure: Figure) -> Iterator[str]:
    for ax in figure.axes:
        cells = _cells(ax)
        if cells.size:
            row, column = np.unravel_index(int(cells.argmax()), cells.shape)
            where = f"row {row + 1}, column {column + 1}"
            yield f"{_title(ax)}: largest in {where} ({_number(float(cells[row, column]))})."


def _meshes(figure: Figure) -> Iterator[str]:
    for ax in figure.axes:
        for cells in ax.collections:
            if type(cells) is PolyCollection:  # and no area below a curve, which is a subclass
                yield f"{_title(ax)}: {_mesh(cells)}."


def _mesh(cells: PolyCollection) -> str:
    paths, values = cells.get_paths(), cells.get_array()
    if values is None:
        return labels.counted(len(paths), "cell")
    at = int(np.argmax(values))
    x, y = np.mean(np.asarray(paths[at].vertices)[:-1], axis=0)
    coloured = labels.counted(len(paths), "coloured cell")
    place = f"{_number(x)}, {_number(y)}"
    return f"{coloured}, the largest value at {place} ({_number(values[at])})"


def _cells(ax: Axes) -> NDArray[np.float64]:
    """Return the cells of a map, −∞ for empty ones; an empty array where no cell has a number."""
    if not ax.images:
        return np.empty(0)
    found: NDArray[np.float64] = np.ma.filled(np.ma.asarray(ax.images[-1].get_array()), np.nan)
    cells = np.where(np.isfinite(found), found, -np.inf)
    return cells if np.isfinite(cells).any() else np.empty(0)


def _remarks(figure: Figure, drawn: set[str]) -> Iterator[str]:
    """Yield a sentence per panel with words in place of data."""
    for ax in figure.axes:
        if ax.texts and _title(ax) not in drawn and not _cells(ax).size:
            yield f"{_title(ax)}: {' '.join(ax.texts[0].get_text().split())}."


def _title(ax: Axes) -> str:
    return ax.get_title(loc="left") or "Panel"


def _range(values: NDArray[np.float64]) -> str:
    low, high = _number(float(values.min())), _number(float(values.max()))
    return low if low == high else f"{low} to {high}"


def _number(value: float) -> str:
    return labels.number(value, digits=3)
