"""The data of a figure, as drawn: its curves and bars as files, in the axes' units, and in words.

Panels hand over the numbers drawn in them. NAME.csv has a row per point; NAME.nc holds
the same as CF's contiguous ragged arrays. Bars of named things have the name in `category`, points
with error bars the ends of these in `low` and `high`. A map of colours has no curves: its numbers
are in analysis.nc.
"""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter
from numpy.typing import ArrayLike, NDArray

from impactlab.figures import labels
from impactlab.files import replaced, write_netcdf
from impactlab.types import Floats


@dataclass(frozen=True)
class Series:
    """One curve, or the ends of one kind of bars: its label, and points of shape (points,).

    low, high: ends of the error bar of each point, along the axis of its value; else NaN.
    """

    label: str
    x: Floats
    y: Floats
    low: Floats
    high: Floats


class Panel(Axes):
    """Axes that keep what `plot`, `step`, `errorbar`, `bar`, `barh` and `hist` draw.

    Lines without a label, or with one that starts with "_", are guides and are left out; "_only"
    labels the only curve of a panel, which needs no name, and "_data: LABEL" one that the legend
    leaves out. names: of the places 0, 1, ... along "x" or "y", see `name_places`.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Begin without data."""
        self.names: dict[str, list[str]] = {}
        self._points: list[tuple[Any, ...]] = []  # arguments of _series
        super().__init__(*args, **kwargs)

    @property
    def series(self) -> list[Series]:
        """The curves and bars, in the order drawn."""
        return [_series(*points) for points in self._points]

    def plot(self, *args: Any, **kwargs: Any) -> list[Line2D]:
        """Draw lines; keep x and y of one that is no guide."""
        label = str(kwargs.get("label") or "_").removeprefix("_data: ")
        if len(args) > 1 and (label == "_only" or not label.startswith("_")):
            self._points.append((label, args[0], args[1]))
        return super().plot(*args, **kwargs)

    def errorbar(
        self,
        x: Any,
        y: Any,
        yerr: Any = None,
        xerr: Any = None,
        fmt: str = "",
        *args: Any,
        **kwargs: Any,
    ) -> ErrorbarContainer:
        """Draw points with error bars along x or else y, and keep both."""
        if fmt != "none":  # else without points: matplotlib's own call for those of bars
            error = (y, yerr) if xerr is None else (x, xerr)
            self._points.append((kwargs.get("label"), x, y, *error))
        return super().errorbar(x, y, yerr, xerr, fmt, *args, **kwargs)

    def bar(self, x: Any, height: Any, *args: Any, **kwargs: Any) -> BarContainer:
        """Draw bars upwards, and keep their middles and heights."""
        if kwargs.get("orientation") != "horizontal":  # as which matplotlib draws those of `barh`
            self._points.append((kwargs.get("label"), x, height, height, kwargs.get("yerr")))
        return super().bar(x, height, *args, **kwargs)

    def barh(self, y: Any, width: Any, *args: Any, **kwargs: Any) -> BarContainer:
        """Draw bars to the right, and keep their lengths and middles."""
        self._points.append((kwargs.get("label"), width, y, width, kwargs.get("xerr")))
        return super().barh(y, width, *args, **kwargs)


def _series(
    label: object, x: ArrayLike, y: ArrayLike, values: ArrayLike = (), error: Any = None
) -> Series:
    """Return points; error: half the length of the bars about their `values`, or (2, points)."""
    across, up = np.broadcast_arrays(*(np.array(v, dtype=float, ndmin=1) for v in (x, y)))
    low, high = np.full((2, across.size), np.nan)
    if error is not None:
        below, above = np.broadcast_to(error, (2, across.size))
        low, high = np.asarray(values, dtype=float) - below, np.asarray(values) + above
    text = str(label or "")
    return Series("" if text.startswith("_") else text, across, up, low, high)


def name_places(ax: Axes, which: str, names: Sequence[str]) -> None:
    """Put names in place of the numbers 0, 1, ... along an axis, "x" or "y"."""
    ax.set(**{f"{which}ticks": range(len(names))})
    getattr(ax, f"{which}axis").set_major_formatter(FixedFormatter(list(names)))
    if isinstance(ax, Panel):
        ax.names[which] = list(names)


FORMATS = ("csv", "nc")
_LABELS = ("panel", "curve", "x_label", "y_label")
_POINTS = {
    "x": "x as drawn, in the unit of x_label",
    "y": "y as drawn, in the unit of y_label",
    "low": "lower end of the error bar, along the axis of the value",
    "high": "upper end of the error bar, along the axis of the value",
}
_PANELS, _CURVES, _BARS = 5, 3, 6
"""Largest numbers of panels, and of curves or kinds of bars per panel, described one by one."""


@dataclass(frozen=True)
class Drawn:
    """One curve: where it is, what it is called, and its points x, y of shape (points,).

    category: the name of each point, where an axis has names in place of numbers (x: `across`);
    else "". low, high: ends of the error bar of each point, along the axis of its value; else NaN.
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

    @property
    def values(self) -> Floats:
        """The numbers: x where y has names in place of them, else y."""
        return self.x if any(self.category) and not self.across else self.y


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write NAME.csv and NAME.nc, atomically; neither where the figure has no curves."""
    curves = list(drawn(figure))
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    if not curves:
        for path in paths:
            path.unlink(missing_ok=True)
        return []
    sizes = [curve.x.size for curve in curves]
    stored = xr.Dataset(attrs={"title": name})
    for key in _LABELS:
        texts = [getattr(curve, key) for curve in curves]
        stored["curve_label" if key == "curve" else key] = ("curve", texts)
    stored["points"] = ("curve", sizes, {"sample_dimension": "point"})
    for key, long_name in _POINTS.items():
        numbers = np.concatenate([getattr(curve, key) for curve in curves])
        stored[key] = ("point", numbers, {"long_name": long_name})
    stored["category"] = ("point", [name for curve in curves for name in curve.category])
    with replaced(paths[0]) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")  # pandas formats numbers slowly
        writer.writerow([*_LABELS, "category", *_POINTS])
        for curve in curves:
            texts = [getattr(curve, key) for key in _LABELS]
            columns = [map(_number, getattr(curve, key).tolist()) for key in _POINTS]
            writer.writerows(
                [*texts, *point] for point in zip(curve.category, *columns, strict=True)
            )
    write_netcdf(stored, paths[1], "figure", dated=False)
    return paths


def _number(value: float) -> str:
    """Return a number with nine digits, "" of NaN."""
    return "" if value != value else f"{value:.9g}"


def drawn(figure: Figure) -> Iterator[Drawn]:
    """Yield the curves and bars of all panels, without guides and points that are not finite."""
    for number, ax in enumerate(figure.axes, 1):
        if isinstance(ax, Panel) and ax.series:
            legend = ax.get_legend()
            title = str(legend.get_title().get_text()) if legend else ""
            panel = _line(ax.get_title(loc="left") or title) or f"panel {number}"
            across, up = _label(figure, ax, "x"), _label(figure, ax, "y")
            if "y" in ax.names:  # an axis of names has no label
                up = str(ax.get_ylabel())
            for series in ax.series:
                finite = np.isfinite(series.x) & np.isfinite(series.y)
                if finite.any():
                    columns = (series.x, series.y, series.low, series.high)
                    x, y, low, high = (column[finite] for column in columns)
                    names, named = _categories(ax, series, finite), "x" in ax.names
                    yield Drawn(panel, series.label, across, up, x, y, low, high, names, named)


def _categories(ax: Panel, series: Series, finite: NDArray[np.bool_]) -> list[str]:
    """Return the name of each finite point, "" where no axis has names; bars lie about theirs."""
    which = next((which for which in ("x", "y") if which in ax.names), None)
    if which is None:
        return [""] * int(finite.sum())
    names, places = ax.names[which], np.rint(getattr(series, which)[finite])
    places = np.clip(places, 0, len(names) - 1).astype(int)
    return [_line(names[place]) for place in places]


def _line(text: str) -> str:
    """Return a text that was wrapped to fit as one line."""
    return " ".join(text.split())


def _label(figure: Figure, ax: Axes, axis: str) -> str:
    """Return the axis's own label, or else the figure's, or else that of its row or column."""
    place = "colspan" if axis == "x" else "rowspan"
    specs = {other: other.get_subplotspec() for other in figure.axes if other.get_subplotspec()}
    span = getattr(specs.get(ax), place, None)
    beside = (
        str(getattr(other, f"get_{axis}label")())
        for other, spec in specs.items()
        if getattr(spec, place) == span
    )
    texts = [getattr(ax, f"get_{axis}label")(), getattr(figure, f"get_sup{axis}label")(), *beside]
    return _line(str(next(filter(None, texts), "")))


def alt(figure: Figure) -> str:
    """Return a sentence per panel: where its bars are longest, or the ranges of its curves."""
    described, panels = [], set()
    for panel, group in groupby(drawn(figure), key=lambda curve: curve.panel):
        curves = list(group)
        panels.add(panel)
        axes = " against ".join(filter(None, (curves[0].y_label, curves[0].x_label)))
        name = axes if panel.startswith("panel ") else panel
        every = len(curves) <= (_BARS if any(curves[0].category) else _CURVES)
        shown = curves if every else [max(curves, key=lambda curve: float(curve.values.max()))]
        text = "; ".join(map(_curve, shown))
        described.append(f"{name}: {text if every else f'highest of {len(curves)}: {text}'}.")
    titles = {ax: _line(ax.get_title(loc="left")) or "Panel" for ax in figure.axes}
    maps = {ax: text for ax in figure.axes if (text := _cells(ax))}
    meshes = [
        f"{titles[ax]}: {_mesh(cells)}."
        for ax in figure.axes
        for cells in ax.collections
        if type(cells) is PolyCollection  # and no area below a curve, which is a subclass
    ]
    remarks = [  # words in place of data
        f"{title}: {_line(ax.texts[0].get_text())}."
        for number, (ax, title) in enumerate(titles.items(), 1)
        if ax.texts and not panels & {title, f"panel {number}"} and ax not in maps
    ]
    described += [f"{titles[ax]}: {text}." for ax, text in maps.items()] + meshes + remarks
    text = " ".join(described[:_PANELS])
    more = len(described) - _PANELS
    return f"{text} And {labels.counted(more, 'more panel')}." if more > 0 else text


def _curve(curve: Drawn) -> str:
    label = f"{curve.curve}: " if curve.curve else ""
    if any(curve.category):
        largest = int(np.argmax(np.abs(curve.values)))
        value = labels.number(curve.values[largest], 3)
        return f"{label}largest for {curve.category[largest]} ({value})"
    if curve.x.size == 1:
        return f"{label}{labels.number(curve.x[0], 3)}, {labels.number(curve.y[0], 3)}"
    return f"{label}{labels.span(curve.y, 3)} over {labels.span(curve.x, 3)}"


def _cells(ax: Axes) -> str:
    """Return where a map is largest, "" without a map or where no cell has a number."""
    if not ax.images:
        return ""
    values: Floats = np.ma.filled(np.ma.asarray(ax.images[-1].get_array()), np.nan)
    if not np.isfinite(values).any():
        return ""
    cells = np.where(np.isfinite(values), values, -np.inf)
    row, column = np.unravel_index(int(cells.argmax()), cells.shape)
    largest = labels.number(float(cells[row, column]), 3)
    return f"largest in row {row + 1}, column {column + 1} ({largest})"


def _mesh(cells: PolyCollection) -> str:
    paths, values = cells.get_paths(), cells.get_array()
    if values is None:
        return labels.counted(len(paths), "cell")
    largest = int(np.argmax(values))
    x, y = np.mean(np.asarray(paths[largest].vertices)[:-1], axis=0)
    place, value = (
        f"{labels.number(x, 3)}, {labels.number(y, 3)}",
        labels.number(values[largest], 3),
    )
    coloured = labels.counted(len(paths), "coloured cell")
    return f"{coloured}, the largest value at {place} ({value})"
