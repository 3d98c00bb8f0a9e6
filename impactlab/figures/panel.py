"""Axes that hand over the numbers drawn in them: the data of a figure (data.py)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter
from numpy.typing import ArrayLike

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
