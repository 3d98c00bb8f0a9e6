"""The look of every figure: paper widths, 8 pt sans serif, colours for the colour-blind too.

Colours: Okabe and Ito (2008), "Color Universal Design".
"""

from __future__ import annotations

import math
import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from impactlab.figures.panel import Panel

SINGLE, DOUBLE = 89.0, 183.0  # widths of one and of two columns of a paper, mm
MILLIMETRE = 1.0 / 25.4  # in inches, matplotlib's unit of length

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
MARKERS = ("o", "s", "^", "D", "v", "P")
LINES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (7, 3)), (0, (3, 1, 1, 1)))
GUIDE: dict[str, Any] = {"color": "0.45", "linewidth": 0.8, "zorder": 1}
"""Look of guide lines, which are no data."""
MUTED = "0.4"

_SETTINGS: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that files are the same everywhere
    **dict.fromkeys(("font.size", "figure.labelsize", "axes.titlesize", "axes.labelsize"), 8),
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize"), 7),
    **dict.fromkeys(("legend.fontsize", "legend.title_fontsize"), 7),
    "legend.frameon": False,
    "legend.handlelength": 3.6,  # shows the line style beside the marker
    "axes.spines.top": False,
    "axes.spines.right": False,
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    **dict.fromkeys(("xtick.minor.width", "ytick.minor.width"), 0.4),
    "axes.grid": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.5,
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.05,
    "svg.fonttype": "path",  # text in the reader's fonts would shift and overlap
    "svg.hashsalt": "impactlab",
    "savefig.dpi": 300,
}
_LOCK = threading.RLock()


@contextmanager
def applied() -> Iterator[None]:
    """Apply the style, in one thread at a time: matplotlib's settings are global."""
    with _LOCK, matplotlib.style.context(["default", _SETTINGS]):
        yield


_NEW: ContextVar[Callable[..., Figure]] = ContextVar("new figures", default=Figure)


@contextmanager
def interactive() -> Iterator[None]:
    """Make new figures with pyplot, which notebooks and windows show."""
    from matplotlib import pyplot  # late: reports do without

    # Loads the backend, so that `applied` does not take back what a notebook's sets.
    pyplot.draw_if_interactive()  # type: ignore[no-untyped-call]
    before = _NEW.set(pyplot.figure)
    try:
        yield
    finally:
        _NEW.reset(before)


paper = applied()
"""Decorator of functions that draw, so that they do it under the style."""


def panels(
    count: int, *, columns: int, height: float, sharex: bool = False, sharey: bool = False
) -> tuple[Figure, list[Axes]]:
    """Return a figure of `count` panels, two columns of a paper wide, or one for one panel per row.

    height: of a row of panels, mm.
    """
    columns = min(columns, count)
    rows = math.ceil(count / columns)
    size = ((SINGLE if columns == 1 else DOUBLE) * MILLIMETRE, rows * height * MILLIMETRE)
    figure = _NEW.get()(figsize=size, layout="constrained")
    kind: Any = {"axes_class": Panel}
    grid = figure.subplots(
        rows, columns, sharex=sharex, sharey=sharey, squeeze=False, subplot_kw=kind
    ).ravel()
    for spare in grid[count:]:
        spare.remove()
    if sharex:  # the panels above the spare ones end their column
        for axes in grid[max(count - columns, 0) : count]:
            axes.tick_params(labelbottom=True)
    return figure, list(grid[:count])


def titled_panels(
    titles: Sequence[str], *, columns: int, height: float, **shared: bool
) -> tuple[Figure, list[Axes]]:
    """Return a panel per title, see `panels`; the figure grows to hold titles of several lines."""
    filled = [textwrap.fill(title, 96 // max(columns, 2)) for title in titles]
    height += 3.4 * max(title.count("\n") for title in filled)
    figure, axes = panels(len(titles), columns=columns, height=height, **shared)
    for ax, title in zip(axes, filled, strict=True):
        ax.set_title(title, loc="left")
    return figure, axes


def legend(figure: Figure, title: str = "", order: Sequence[str] = ()) -> None:
    """Add one legend of all labelled artists above the panels; the figure grows to hold it.

    order: labels in the order wanted; without it, that in which they are drawn. Guides labelled
    "_guide: WORDS" come last. A label that is a line in one panel and markers in another is both
    in the legend.
    """
    entries: dict[str, dict[str, Any]] = {}
    guides: dict[str, dict[str, Any]] = {}
    for axes in figure.axes:
        for line in axes.lines:
            start, _, text = str(line.get_label()).partition("_guide: ")
            if text and not start:
                guides.setdefault(text, {"line": line})
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            alone = isinstance(handle, Line2D) and handle.get_linestyle() in ("", "None")
            entries.setdefault(label, {}).setdefault("markers" if alone else "line", handle)
    if len(entries) + len(guides) < 2 and not title:
        return
    entries = {label: entries[label] for label in order if label in entries} or entries
    entries |= guides
    columns = _columns(figure.get_figwidth() / MILLIMETRE, list(entries))
    rows = math.ceil(len(entries) / columns) + bool(title)
    figure.set_figheight(figure.get_figheight() + (rows * 4.2 + 1.0) * MILLIMETRE)
    handles: Any = [tuple(kinds.values()) for kinds in entries.values()]
    figure.legend(
        handles, list(entries), loc="outside upper center", ncols=columns, title=title or None
    )


def finish(
    figure: Figure, x: str = "", y: str = "", *, title: str = "", order: Sequence[str] = ()
) -> Figure:
    """Add labels that hold for all panels, and the legend (see `legend`); return the figure."""
    if x:
        figure.supxlabel(x)
    if y:
        figure.supylabel(y)
    legend(figure, title, order)
    return figure


def panel_legends(figure: Figure) -> None:
    """Add a legend above each panel, under its title; the figure grows to hold them."""
    rows = 0
    for axes in figure.axes:
        handles, labels = axes.get_legend_handles_labels()
        place = axes.get_subplotspec()
        assert place is not None
        width = figure.get_figwidth() / MILLIMETRE / place.get_gridspec().ncols - _MARGIN
        columns = _columns(width, labels, letter=1.4)
        rows = max(rows, math.ceil(len(labels) / columns))
        if len(labels) > 1:
            axes.legend(handles, labels, title=axes.get_title(loc="left"), ncols=columns, **_ABOVE)
            axes.set_title("", loc="left")
    lines = figure.axes[0].get_subplotspec().get_gridspec().nrows  # type: ignore[union-attr]
    figure.set_figheight(figure.get_figheight() + lines * rows * 4.2 * MILLIMETRE)


_MARGIN = 15.0  # left of a panel, for numbers and label, mm
_ABOVE: dict[str, Any] = {
    "loc": "lower left",
    "bbox_to_anchor": (0.0, 1.0),
    "borderaxespad": 0.0,
    "borderpad": 0.2,
    "alignment": "left",
    "title_fontsize": 8,
}


def _columns(width: float, labels: list[str], letter: float = 1.6) -> int:
    """Return the columns that fit into a width in mm; letters are up to 1.6 mm wide at 7 pt."""
    longest = max((len(label) for label in labels), default=1)
    fit = int(width / (letter * longest + 12.5))
    return max(1, min(fit, len(labels)))


def distinct(number: int) -> dict[str, Any]:
    """Return colour, line and marker of the curve of this number, alike in all panels."""
    return {
        "color": COLOURS[number % len(COLOURS)],
        "linestyle": LINES[number // len(COLOURS) % len(LINES)],
        "marker": MARKERS[number // len(COLOURS) % len(MARKERS)],
    }


def note(
    axes: Axes,
    text: str,
    place: tuple[float, float],
    offset: tuple[float, float],
    *,
    warning: bool,
    **where: Any,
) -> None:
    """Write small print `offset` points from a place, bold where it is a warning."""
    look: dict[str, Any] = {"fontweight": "normal", "color": MUTED, "fontsize": 7}
    look |= {"fontweight": "bold", "color": COLOURS[1]} if warning else {}
    axes.annotate(text, place, offset, textcoords="offset points", **look, **where)


def remark(axes: Axes, text: str = "no finite values") -> None:
    """Write words in place of data, in the middle of empty axes."""
    axes.grid(visible=False)
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=MUTED)
