"""The data of a figure, as drawn: its curves and bars as files, in the axes' units, and in words.

NAME.csv has a row per point; NAME.nc holds the same as CF's contiguous ragged arrays. Bars of named
things have the name in `category`, points with error bars the ends of these in `low` and `high`. A
map of colours has no curves: its numbers are in analysis.nc.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter

from impactlab.figures import labels
from impactlab.files import replaced, write_netcdf
from impactlab.types import Floats

FORMATS = ("csv", "nc")
_LABELS = ("panel", "curve", "x_label", "y_label")
_POINTS = {
    "x": "x as drawn, in the unit of x_label",
    "y": "y as drawn, in the unit of y_label",
    "low": "lower end of the error bar, along the axis of the value",
    "high": "upper end of the error bar, along the axis of the value",
}
_PANELS, _CURVES = 5, 3
"""Largest numbers of panels, and of curves per panel, that are described one by one."""


@dataclass(frozen=True)
class Drawn:
    """One curve: where it is, what it is called, and its points x, y of shape (points,).

    category: the name of each point, where an axis has names in place of numbers (x: `across`);
    else "". low,
    high: ends of the error bar of each point, (points,), along the axis of its value; else NaN.
    """

    panel: str
    curve: str
    x_label: str
    y_label: str
    x: Floats
    y: Floats
    low: Floats
    high: Floats
    category: list[str]
    across: bool = False


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write NAME.csv and NAME.nc, atomically; neither where the figure has no curves."""
    found = list(drawn(figure))
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    if not found:
        for path in paths:
            path.unlink(missing_ok=True)
        return []
    sizes = [one.x.size for one in found]
    stored = xr.Dataset(attrs={"title": name})
    for key in _LABELS:
        words = [getattr(one, key) for one in found]
        stored["curve_label" if key == "curve" else key] = ("curve", words)
    stored["points"] = ("curve", sizes, {"sample_dimension": "point"})
    for key, long_name in _POINTS.items():
        numbers = np.concatenate([getattr(one, key) for one in found])
        stored[key] = ("point", numbers, {"long_name": long_name})
    stored["category"] = ("point", [each for one in found for each in one.category])
    of_point = xr.DataArray(np.repeat(np.arange(len(found)), sizes), dims="point")
    table = stored.isel(curve=of_point).rename(curve_label="curve").to_dataframe()
    header = [*_LABELS, "category", *_POINTS]
    with replaced(paths[0]) as temporary:
        table[header].to_csv(temporary, index=False, float_format="%.9g", lineterminator="\n")
    write_netcdf(stored, paths[1], "figure", dated=False)
    return paths


def drawn(figure: Figure) -> Iterator[Drawn]:
    """Yield the curves and bars of all panels, without guides and points that are not finite."""
    for number, ax in enumerate(figure.axes, 1):
        if not (ax.lines or ax.containers):  # the colour bar of a map
            continue
        across, up = _label(figure, ax, "x"), _label(figure, ax, "y")
        legend = ax.get_legend()
        title = str(legend.get_title().get_text()) if legend else ""
        panel = ax.get_title(loc="left") or title or f"panel {number}"
        formatter, names = ax.yaxis.get_major_formatter(), [""]
        if isinstance(formatter, FixedFormatter):  # an axis of names has no label
            names, up = [str(of) for of in formatter.seq], str(ax.get_ylabel())
        formatter = ax.xaxis.get_major_formatter()
        if named := isinstance(formatter, FixedFormatter):
            names = [str(of) for of in formatter.seq]
        for curve, x, y, low, high in _points(ax):
            kept = np.isfinite(x) & np.isfinite(y)
            places = (x if named else y)[kept]
            nearest = np.clip(np.rint(places), 0, len(names) - 1).astype(int)
            if kept.any():
                category = [names[at] for at in nearest]
                ends = low[kept], high[kept]
                yield Drawn(panel, curve, across, up, x[kept], y[kept], *ends, category, named)


def _label(figure: Figure, ax: Axes, axis: str) -> str:
    """Return the axis's own label, or else the figure's, or else that of its row or column."""
    own = str(getattr(ax, f"get_{axis}label")())
    whole = str(getattr(figure, f"get_sup{axis}label")())
    place = "colspan" if axis == "x" else "rowspan"
    here = {other: other.get_subplotspec() for other in figure.axes if other.get_subplotspec()}
    span = getattr(here.get(ax), place, None)
    beside = (
        str(getattr(other, f"get_{axis}label")())
        for other, spec in here.items()
        if getattr(spec, place) == span
    )
    found = own or whole or next(filter(None, beside), "")
    return " ".join(found.split())


def _points(ax: Axes) -> Iterator[tuple[str, Floats, Floats, Floats, Floats]]:
    """Yield label, x, y, low and high of lines but guides, of points with bars, of bars' ends."""
    for line in ax.lines:
        label = str(line.get_label())
        if label == "_only" or not label.startswith("_"):
            x, y = (np.asarray(values, dtype=float) for values in line.get_data())
            yield label.removeprefix("_only"), x, y, *np.full((2, x.size), np.nan)
    for each in ax.containers:
        label = str(each.get_label())
        label = "" if label.startswith("_") else label  # a name that matplotlib makes up
        if isinstance(each, ErrorbarContainer) and each.lines[0] is not None:
            x, y = (np.asarray(values, dtype=float) for values in each.lines[0].get_data())
            yield label, x, y, *_ends(each, x.size)
        elif isinstance(each, BarContainer):
            boxes = np.array([box.get_bbox().extents for box in each], dtype=float).reshape(-1, 4)
            left, bottom, right, top = boxes.T
            level = each.orientation == "horizontal"
            x, y = (right, 0.5 * (bottom + top)) if level else (0.5 * (left + right), top)
            yield label, x, y, *_ends(each.errorbar, x.size)


def _ends(bars: ErrorbarContainer | None, size: int) -> Floats:
    """Return the lower and upper ends of error bars, (2, points), NaN without one."""
    found = np.full((2, size), np.nan)
    for each in bars.lines[2] if bars else ():
        axis = 0 if bars and bars.has_xerr else 1
        ends = [part[:, axis] if len(part) else (np.nan,) * 2 for part in each.get_segments()]
        found[:] = np.sort(np.array(ends, dtype=float).T, axis=0)
    return found


def alt(figure: Figure) -> str:
    """Return a sentence per panel: where its bars are longest, or the ranges of its curves."""
    described, panels = [], set()
    for panel, group in groupby(drawn(figure), key=lambda curve: curve.panel):
        found = list(group)
        panels.add(panel)
        axes = " against ".join(filter(None, (found[0].y_label, found[0].x_label)))
        name = axes if panel.startswith("panel ") else panel
        every = len(found) <= _CURVES or any(found[0].category)
        shown = found if every else [max(found, key=lambda curve: float(curve.y.max()))]
        text = "; ".join(map(_curve, shown))
        described.append(f"{name}: {text if every else f'highest of {len(found)}: {text}'}.")
    titles = {ax: ax.get_title(loc="left") or "Panel" for ax in figure.axes}
    cells = {ax: text for ax in figure.axes if (text := _cells(ax))}
    meshes = [
        f"{titles[ax]}: {_mesh(each)}."
        for ax in figure.axes
        for each in ax.collections
        if type(each) is PolyCollection  # and no area below a curve, which is a subclass
    ]
    remarks = [  # words in place of data
        f"{title}: {' '.join(ax.texts[0].get_text().split())}."
        for ax, title in titles.items()
        if ax.texts and title not in panels and ax not in cells
    ]
    described += [f"{titles[ax]}: {text}." for ax, text in cells.items()] + meshes + remarks
    text = " ".join(described[:_PANELS])
    more = len(described) - _PANELS
    return f"{text} And {labels.counted(more, 'more panel')}." if more > 0 else text


def _curve(curve: Drawn) -> str:
    label = f"{curve.curve}: " if curve.curve else ""
    if any(curve.category):
        values = curve.y if curve.across else curve.x
        at = int(np.argmax(np.abs(values)))
        return f"{label}largest for {curve.category[at]} ({labels.number(values[at], 3)})"
    if curve.x.size == 1:
        return f"{label}{labels.number(curve.x[0], 3)}, {labels.number(curve.y[0], 3)}"
    return f"{label}{labels.span(curve.y, 3)} over {labels.span(curve.x, 3)}"


def _cells(ax: Axes) -> str:
    """Return where a map is largest, "" without a map or where no cell has a number."""
    if not ax.images:
        return ""
    found: Floats = np.ma.filled(np.ma.asarray(ax.images[-1].get_array()), np.nan)
    if not np.isfinite(found).any():
        return ""
    cells = np.where(np.isfinite(found), found, -np.inf)
    row, column = np.unravel_index(int(cells.argmax()), cells.shape)
    largest = labels.number(float(cells[row, column]), 3)
    return f"largest in row {row + 1}, column {column + 1} ({largest})"


def _mesh(cells: PolyCollection) -> str:
    paths, values = cells.get_paths(), cells.get_array()
    if values is None:
        return labels.counted(len(paths), "cell")
    at = int(np.argmax(values))
    x, y = np.mean(np.asarray(paths[at].vertices)[:-1], axis=0)
    place, largest = f"{labels.number(x, 3)}, {labels.number(y, 3)}", labels.number(values[at], 3)
    coloured = labels.counted(len(paths), "coloured cell")
    return f"{coloured}, the largest value at {place} ({largest})"
