"""The look of every figure: paper widths, 8 pt sans serif, colours for the colour-blind too.

Colours: Okabe and Ito (2008), "Color Universal Design".
"""

import math
import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import matplotlib.style
import xarray as xr
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from impactlab.figures import access, labels
from impactlab.figures.access import usable
from impactlab.figures.data import Panel
from impactlab.figures.labels import display

SINGLE, DOUBLE = 89.0, 183.0  # widths of one and of two columns of a paper, mm
PAGE = 230.0  # height of a page of a paper that leaves room for a caption, mm
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
    "axes.ymargin": 0.08,
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
    "pdf.fonttype": 42,  # letters stay letters; publishers refuse those of type 3
    "savefig.dpi": 300,
}
SHEETS: dict[str, tuple[str, ...]] = {
    "plain": (),
    "nature": ("science", "misc/no-latex", "journals/nature"),
    "science": ("science", "misc/no-latex"),
}
"""Style sheets of SciencePlots by style; "plain" is the look of the reports."""
_BOXED: dict[str, Any] = {"axes.spines.top": True, "axes.spines.right": True, "axes.grid": False}
"""What those sheets take from matplotlib's defaults."""
_FALLBACK = "DejaVu Sans"
"""Font of the letters that a sheet's font lacks, such as raised minus signs."""
_LOCK = threading.RLock()
_STYLE: ContextVar[str] = ContextVar("style", default="plain")


@contextmanager
def chosen(name: str) -> Iterator[None]:
    """Draw in one of the styles of SHEETS."""
    before = _STYLE.set(name)
    try:
        yield
    finally:
        _STYLE.reset(before)


def _files(sheets: Sequence[str]) -> list[Path]:
    """Return the files of SciencePlots' sheets; the package, when imported, loads pyplot."""
    package = find_spec("scienceplots") if sheets else None
    folders = package.submodule_search_locations if package else None
    return [
        Path(folder, "styles", f"{sheet}.mplstyle") for folder in folders or () for sheet in sheets
    ]


@contextmanager
def applied() -> Iterator[None]:
    """Apply the style, in one thread at a time: matplotlib's settings are global."""
    sheets = _files(SHEETS[_STYLE.get()])
    with _LOCK, matplotlib.style.context(["default", _SETTINGS]):
        if sheets:
            matplotlib.style.use([_BOXED, *sheets])
            serif = rcParams["font.family"] == ["serif"]
            fonts = rcParams["font.serif" if serif else "font.sans-serif"]
            rcParams["font.family"] = [fonts[0], _FALLBACK]
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


@dataclass
class Alone:
    """A panel that is drawn alone: its number, and the figure's width in mm.

    count: number of panels of the whole figure, 0 until it is drawn (or if it has no panels).
    """

    number: int
    width: float
    count: int = 0


_ALONE: ContextVar[Alone | None] = ContextVar("panel drawn alone", default=None)


@contextmanager
def alone(number: int, width: float) -> Iterator[Alone]:
    """Let `panels` return a figure that holds one panel, laid out for a width in mm."""
    panel = Alone(number, width)
    before = _ALONE.set(panel)
    try:
        yield panel
    finally:
        _ALONE.reset(before)


_FLATTEST = 0.62
"""Least height over width of a panel that is drawn alone."""


def _one_of(
    panel: Alone, count: int, height: float, *, sharex: bool, sharey: bool
) -> tuple[Figure, list[Axes]]:
    """Return a figure of one panel, and all panels: the others are on a page that is left."""
    panel.count = count
    height = min(max(height, _FLATTEST * panel.width), PAGE)
    size = panel.width * MILLIMETRE, height * MILLIMETRE
    figure = Figure(figsize=size, layout="constrained")
    left, axes = Figure(), list[Axes]()
    for number in range(count):
        page = figure if number == panel.number else left
        first = axes[0] if axes else None
        axes.append(
            page.add_subplot(
                axes_class=Panel, sharex=first if sharex else None, sharey=first if sharey else None
            )
        )
    return figure, axes


def panels(
    count: int,
    *,
    columns: int,
    height: float,
    width: float = 0.0,
    sharex: bool = False,
    sharey: bool = False,
) -> tuple[Figure, list[Axes]]:
    """Return a figure of `count` panels; its height is at most that of a page.

    height: of a row of panels, mm. width: mm; without it, that of two columns of a paper, or of one
    for one panel per row.
    """
    if (panel := _ALONE.get()) is not None:
        return _one_of(panel, count, height, sharex=sharex, sharey=sharey)
    columns = min(columns, count)
    rows = math.ceil(count / columns)
    width = width or (SINGLE if columns == 1 else DOUBLE)
    size = width * MILLIMETRE, min(rows * height, PAGE) * MILLIMETRE
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


def starts_row(axes: Axes) -> bool:
    """Return whether a panel is the first of its row."""
    place = axes.get_subplotspec()
    return place is not None and place.is_first_col()


def grow(figure: Figure, height: float) -> None:
    """Make room of a height in mm; beyond the height of a page, the panels give way."""
    figure.set_figheight(min(figure.get_figheight() + height * MILLIMETRE, PAGE * MILLIMETRE))


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
    width = figure.get_figwidth() / MILLIMETRE
    columns, title = _columns(width, list(entries)), textwrap.fill(title, int(width / 1.45))
    rows = math.ceil(len(entries) / columns) + len(title.splitlines())
    grow(figure, rows * 4.2 + 1.0)
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


def _columns(width: float, entries: list[str]) -> int:
    """Return the columns, evenly filled, that fit a width in mm; letters take 1.45 mm at 7 pt."""
    longest = max(map(len, entries), default=1)
    fit = max(1, int(width / (1.45 * longest + 15.5)))
    rows = math.ceil(len(entries) / fit)
    return max(1, math.ceil(len(entries) / max(rows, 1)))


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


_COLUMNS, _SQUARE = 3, 4  # columns of panels, but for the number of panels that makes a square
_ALONE_HEIGHT = 50.0
"""Least height of a panel that stands alone, mm."""


def response_panels(
    names: Sequence[str], height: float, beneath: float = 0.0
) -> tuple[Figure, dict[str, Axes]]:
    """Return a figure with a panel per response, under its name.

    height: of a row, mm; beneath: of what stands below all rows, mm.
    """
    height = max(height, _ALONE_HEIGHT) if len(names) == 1 else height
    titles = [labels.title(name) for name in names]
    columns = 2 if len(names) == _SQUARE else _COLUMNS
    figure, axes = titled_panels(titles, columns=columns, height=height)
    grow(figure, beneath)
    return figure, dict(zip(names, axes, strict=True))


def in_display_units(runs: xr.Dataset, name: str) -> tuple[xr.DataArray, str]:
    """Return a response's usable values in display units, with its name and unit for a label."""
    values = usable(runs, name)
    unit = display(values)
    return values * unit.scale, labels.axis(labels.response(name), unit.symbol)


def warn(ax: Axes, verdict: access.StatedVerdict | None) -> None:
    """Write a verdict under the panel's title if it is a warning."""
    if verdict and not verdict.sound:
        write_verdict(ax, verdict)


def write_verdict(ax: Axes, verdict: access.StatedVerdict | None) -> None:
    """Write a verdict, if there is one, under the panel's title, bold where it is a warning."""
    if verdict is None:
        return
    ax.set_title(ax.get_title(loc="left"), loc="left", pad=12)
    place, warning = (0.0, 1.0), not verdict.sound
    note(ax, verdict.words, place, (0, 3), warning=warning, xycoords="axes fraction")


def empty(ax: Axes, text: str = "no finite values") -> None:
    """Write words in place of curves, and leave out the ticks."""
    remark(ax, text)
    ax.set(xticks=[], yticks=[])
