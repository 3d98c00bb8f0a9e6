"""Small multiples: a panel per response."""

from collections.abc import Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, labels, style
from impactlab.figures.access import usable
from impactlab.figures.labels import display

_COLUMNS, _SQUARE = 3, 4  # columns of panels, but for the number of panels that makes a square
_ALONE = 50.0
"""Least height of a panel that stands alone, mm."""


def panels(
    names: Sequence[str], height: float, beneath: float = 0.0
) -> tuple[Figure, dict[str, Axes]]:
    """Return a figure with a panel per response, under its name.

    height: of a row, mm; beneath: of what stands below all rows, mm.
    """
    height = max(height, _ALONE) if len(names) == 1 else height
    titles = [labels.title(name) for name in names]
    columns = 2 if len(names) == _SQUARE else _COLUMNS
    figure, axes = style.titled_panels(titles, columns=columns, height=height)
    style.grow(figure, beneath)
    return figure, dict(zip(names, axes, strict=True))


def shown(runs: xr.Dataset, name: str) -> tuple[xr.DataArray, str]:
    """Return a response's usable values in display units, with its name and unit for a label."""
    values = usable(runs, name)
    unit = display(values)
    return values * unit.scale, labels.axis(labels.response(name), unit.symbol)


def warn(ax: Axes, verdict: access.StatedVerdict | None) -> None:
    """Write a verdict under the panel's title if it is a warning."""
    if verdict and not verdict.sound:
        write(ax, verdict)


def write(ax: Axes, verdict: access.StatedVerdict | None) -> None:
    """Write a verdict, if there is one, under the panel's title, bold where it is a warning."""
    if verdict is None:
        return
    ax.set_title(ax.get_title(loc="left"), loc="left", pad=12)
    place, warning = (0.0, 1.0), not verdict.sound
    style.note(ax, verdict.words, place, (0, 3), warning=warning, xycoords="axes fraction")


def empty(ax: Axes, text: str = "no finite values") -> None:
    """Write words in place of curves, and leave out the ticks."""
    style.remark(ax, text)
    ax.set(xticks=[], yticks=[])
