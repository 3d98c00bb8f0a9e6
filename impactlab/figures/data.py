"""The data behind a figure, as drawn: every curve and every row of bars, in the axes' units.

NAME.csv has a row per point; NAME.nc holds the same as CF's contiguous ragged arrays. Bars of named
things have the name in `category`. A map of colours has no curves: its numbers are in analysis.nc.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter
from numpy.typing import NDArray

from impactlab.files import replaced

FORMATS = ("csv", "nc")
Points = tuple[str, NDArray[np.float64], NDArray[np.float64]]
"""Label, x and y."""
_LABELS = ("panel", "curve", "x_label", "y_label")


@dataclass(frozen=True)
class Drawn:
    """One curve: where it is, what it is called, and its points x, y of shape (points,).

    category: the name of each point, where the axis has names in place of numbers; else "".
    """

    panel: str
    curve: str
    x_label: str
    y_label: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    category: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Fill in empty categories."""
        if not self.category:
            object.__setattr__(self, "category", [""] * self.x.size)


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write NAME.csv and NAME.nc, atomically; neither where the figure has no curves."""
    found = list(drawn(figure))
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    if not found:
        for path in paths:
            path.unlink(missing_ok=True)
        return []
    with replaced(paths[0]) as temporary:
        _write_csv(found, temporary)
    with replaced(paths[1]) as temporary:
        dataset(found).to_netcdf(temporary, engine="netcdf4")
    return paths


def drawn(figure: Figure) -> Iterator[Drawn]:
    """Yield the curves and bars of all panels, without guides and points that are not finite."""
    for number, ax in enumerate(figure.axes, 1):
        if not _has_data(ax):
            continue
        labels = _label(figure, ax, "x"), _label(figure, ax, "y")
        panel = ax.get_title(loc="left") or _legend_title(ax) or f"panel {number}"
        for curve, x, y in (*_lines(ax), *_marked(ax), *_bars(ax)):
            kept = np.isfinite(x) & np.isfinite(y)
            if kept.any():
                yield Drawn(panel, curve, *labels, x[kept], y[kept], _categories(ax, y[kept]))


def dataset(found: list[Drawn]) -> xr.Dataset:
    """Return the curves on `curve`, with their points one after another on `point`."""
    columns = {
        name if name != "curve" else "curve_label": ("curve", [getattr(one, name) for one in found])
        for name in _LABELS
    }
    counts = ("curve", [one.x.size for one in found], {"sample_dimension": "point"})
    points = {
        axis: (
            "point",
            np.concatenate([getattr(one, axis) for one in found]),
            {"long_name": f"{axis} as drawn, in the unit of {axis}_label"},
        )
        for axis in ("x", "y")
    }
    category = ("point", [name for one in found for name in one.category])
    return xr.Dataset({**columns, "points": counts, **points, "category": category})


def _write_csv(found: list[Drawn], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*_LABELS, "category", "x", "y"])
        for one in found:
            labels = [getattr(one, name) for name in _LABELS]
            points = zip(one.category, one.x.tolist(), one.y.tolist(), strict=True)
            writer.writerows([*labels, name, f"{x:.9g}", f"{y:.9g}"] for name, x, y in points)


def _lines(ax: Axes) -> Iterator[Points]:
    for line in ax.lines:
        label = str(line.get_label())
        if label == "_only" or not label.startswith("_"):
            x, y = (np.asarray(values, dtype=float) for values in line.get_data())
            yield label.removeprefix("_only"), x, y


def _marked(ax: Axes) -> Iterator[Points]:
    """Yield points with lines for their intervals."""
    for marks in ax.containers:
        if isinstance(marks, ErrorbarContainer) and marks.lines[0] is not None:
            x, y = (np.asarray(values, dtype=float) for values in marks.lines[0].get_data())
            yield _own(str(marks.get_label())), x, y


def _bars(ax: Axes) -> Iterator[Points]:
    """Yield bars by their middles and their ends."""
    for bars in ax.containers:
        if not isinstance(bars, BarContainer):
            continue
        label = str(bars.get_label())
        boxes = np.array([box.get_bbox().extents for box in bars], dtype=float).reshape(-1, 4)
        left, bottom, right, top = boxes.T
        if bars.orientation == "horizontal":
            x, y = right, 0.5 * (bottom + top)
        else:
            x, y = 0.5 * (left + right), top
        yield _own(label), x, y


def _own(label: str) -> str:
    """Return the label, "" for the names that matplotlib makes up."""
    return "" if label.startswith("_") else label


def _categories(ax: Axes, y: NDArray[np.float64]) -> list[str]:
    """Return the names on the vertical axis nearest to y; none where it has numbers."""
    formatter = ax.yaxis.get_major_formatter()
    if not isinstance(formatter, FixedFormatter):
        return []
    names = [str(name) for name in formatter.seq]
    return [names[int(at)] for at in np.clip(np.rint(y), 0, len(names) - 1)]


def _has_data(ax: Axes) -> bool:
    """Return whether the axes hold data, and are not the colour bar of a map."""
    return bool(ax.lines or ax.containers)


def _label(figure: Figure, ax: Axes, axis: str) -> str:
    """Return the axis's own label, or else the whole figure's, or else that of another panel."""
    own = str(getattr(ax, f"get_{axis}label")())
    whole = str(getattr(figure, f"get_sup{axis}label")())
    others = (str(getattr(other, f"get_{axis}label")()) for other in figure.axes)
    found = own or whole or next(filter(None, others), "")
    return " ".join(found.split())


def _legend_title(ax: Axes) -> str:
    legend = ax.get_legend()
    return str(legend.get_title().get_text()) if legend else ""
