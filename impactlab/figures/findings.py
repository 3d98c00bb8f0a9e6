"""Figures of a verification: all comparisons on one axis, and the curves of each check."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import labels, scales, style
from impactlab.figures.labels import Display, display
from impactlab.verification.finding import Curve, Outcome, Panel

_ROW = 8.0
"""Height of a check's row, mm."""
_LEAST, _MOST = 1e-6, 1e3
"""Limits of the ratios; those beyond are drawn at the edge."""
_SPREAD = 0.32
"""Largest distance of points from the middle of their row, in rows."""
_LETTERS = 34
_LOOKS: dict[str, dict[str, Any]] = {
    "passed": {"marker": "o", "color": style.COLOURS[0], "alpha": 0.7},
    "failed": {"marker": "X", "color": style.COLOURS[1], "markersize": 6.0},
}
_COLUMNS = 2
_HEIGHT = 58.0
"""Height of a panel, mm."""
_FEW = 25
"""Number of points up to which a curve has markers."""
_TITLE, _LABEL = 46, 32
"""Letters per line of a panel's title, and of the label at its side."""


def overview_caption(outcomes: Sequence[Outcome]) -> str:
    """Return the caption, with the numbers of points at the edges."""
    ratios = np.concatenate([_ratios(outcome) for outcome in outcomes])
    small = int(np.count_nonzero(ratios < _LEAST))
    large = int(np.count_nonzero(ratios > _MOST))
    edges = [
        f"{count} {side} {labels.number(limit)} or {tail}"
        for count, side, limit, tail in (
            (small, "below", _LEAST, "without any error at the left edge"),
            (large, "above", _MOST, "without a number at the right edge"),
        )
        if count
    ]
    shown = f" Drawn as triangles: {labels.listing(edges)}." if edges else ""
    return (
        "Error over tolerance, a point per comparison and a row per check; right of the line at "
        f"1 a comparison fails. Within a row, points are spread in the order of the "
        f"comparisons.{shown}"
    )


@style.paper
def plot_overview(outcomes: Sequence[Outcome]) -> Figure:
    """Draw a row per check, the first on top; failed comparisons have a shape of their own."""
    size = (style.DOUBLE * style.MILLIMETRE, (18.0 + _ROW * len(outcomes)) * style.MILLIMETRE)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    for row, outcome in enumerate(outcomes):
        _draw_row(axes, row, outcome)
    axes.axvline(1.0, label="_limit", **style.GUIDE)
    _finish_overview(axes, outcomes)
    style.legend(figure, order=["passed", "failed"])
    return figure


def _draw_row(axes: Axes, row: int, outcome: Outcome) -> None:
    ratios = _ratios(outcome)
    places = row + np.linspace(-_SPREAD, _SPREAD, ratios.size) if ratios.size > 1 else row
    passed = np.array([entry.passed for entry in outcome.finding.comparisons], dtype=bool)
    shown = np.clip(ratios, _LEAST, _MOST)
    for verdict, chosen in (("passed", passed), ("failed", ~passed)):
        for marker, beyond in (("<", ratios < _LEAST), (">", ratios > _MOST), (None, None)):
            inside = (ratios >= _LEAST) & (ratios <= _MOST) if beyond is None else beyond
            if not (mask := chosen & inside).any():
                continue
            look = _LOOKS[verdict] | ({"marker": marker} if marker else {})
            label = verdict if marker is None else f"_{verdict}"
            y = np.broadcast_to(places, ratios.shape)[mask]
            axes.plot(shown[mask], y, linestyle="", markeredgewidth=0.0, label=label, **look)
    text, failed = _count(outcome)
    axes.annotate(
        text,
        (1.0, row),
        (3, 0),
        xycoords=axes.get_yaxis_transform(),
        textcoords="offset points",
        va="center",
        fontsize=7,
        fontweight="bold" if failed else "normal",
        color=style.COLOURS[1] if failed else style.MUTED,
    )


def _ratios(outcome: Outcome) -> NDArray[np.float64]:
    return np.array([entry.ratio for entry in outcome.finding.comparisons], dtype=float)


def _least(outcomes: Sequence[Outcome]) -> float:
    """Return the decade below all that is drawn."""
    ratios = np.clip(np.concatenate([_ratios(o) for o in outcomes] + [[0.01]]), _LEAST, _MOST)
    return float(10.0 ** np.floor(np.log10(ratios.min())))


def _count(outcome: Outcome) -> tuple[str, bool]:
    """Return the text to the right of a row, and whether it is bad news."""
    total, failed = len(outcome.finding.comparisons), len(outcome.failures)
    if outcome.verdict == "error" or not total:
        return ("error" if outcome.reason else "nothing"), True
    return (f"{failed} of {total} failed", True) if failed else (f"all {total}", False)


def _finish_overview(axes: Axes, outcomes: Sequence[Outcome]) -> None:
    """Scale x in decades to the ratios, and write the checks' titles along y."""
    largest = max((float(_ratios(outcome).max(initial=0.0)) for outcome in outcomes), default=0.0)
    limits = 0.6 * _least(outcomes), 2.5 * min(max(largest, 4.0), _MOST)
    scales.logarithmic(axes, "x", limits, ticks=8)
    axes.set(xlim=limits, ylim=(len(outcomes) - 0.5, -0.5), xlabel="Error over tolerance (–)")
    axes.set_yticks(
        range(len(outcomes)), [fill(outcome.title, width=_LETTERS) for outcome in outcomes]
    )
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    for row in range(1, len(outcomes)):
        axes.axhline(row - 0.5, color="0.85", linewidth=0.5)


def has_curves(outcome: Outcome) -> bool:
    """Return whether the check gave curves."""
    return any(panel.curves for panel in outcome.finding.panels)


def curves_caption(outcome: Outcome) -> str:
    """Return the caption, which tells the two kinds of curves apart."""
    return (
        "Coloured lines or filled markers: the solver. Black broken lines or open markers: "
        f"independent ({outcome.source})."
    )


@style.paper
def plot_curves(outcome: Outcome) -> Figure:
    """Draw the check's panels in two columns, with one legend where it is the same in all."""
    panels = [panel for panel in outcome.finding.panels if panel.curves]
    figure, axes = style.panels(len(panels), columns=_COLUMNS, height=_HEIGHT)
    looks = [_looks(panel) for panel in panels]
    for ax, panel, look in zip(axes, panels, looks, strict=True):
        _draw_panel(ax, panel, look)
    if all(look == looks[0] for look in looks):
        style.legend(figure, order=list(looks[0]))
    else:
        style.panel_legends(figure)
    return figure


def _looks(panel: Panel) -> dict[str, dict[str, Any]]:
    """Return the looks by label: the solver's coloured, then independent ones black and broken."""
    ours, independent = (
        dict.fromkeys(_label(c, panel.curves) for c in panel.curves if c.independent == kind)
        for kind in (False, True)
    )
    looks = {label: _coloured(at) for at, label in enumerate(ours)}
    return looks | {label: _broken(at) for at, label in enumerate(independent)}


def _label(curve: Curve, others: Sequence[Curve]) -> str:
    """Return the curve's label, changed where the solver's has the same."""
    same = any(curve.label == other.label and not other.independent for other in others)
    return f"{curve.label}, independent" if curve.independent and same else curve.label


def _coloured(at: int) -> dict[str, Any]:
    count = len(style.COLOURS)
    return {
        "color": style.COLOURS[at % count],
        "linestyle": style.LINES[at // count % len(style.LINES)],
        "linewidth": 1.6,
        "zorder": 3.0 - 0.01 * at,
        # one further each time round, so that no colour has its marker twice
        "marker": style.MARKERS[(at + at // count) % len(style.MARKERS)],
    }


def _broken(at: int) -> dict[str, Any]:
    broken = style.LINES[1:]
    return {
        "color": "black",
        "linestyle": broken[at % len(broken)],
        "linewidth": 0.9,
        "zorder": 4.0,
        "marker": style.MARKERS[at % len(style.MARKERS)],
        "markerfacecolor": "none",
        "markersize": 6.5,
        "markeredgewidth": 0.8,
    }


def _draw_panel(ax: Axes, panel: Panel, looks: dict[str, dict[str, Any]]) -> None:
    units = [_unit(panel, axis) for axis in ("x", "y")]
    ax.set_title(fill(labels.sentence(panel.title), width=_TITLE), loc="left")
    names = panel.x[0], panel.y[0]
    texts = [labels.axis(n, unit.symbol) for n, unit in zip(names, units, strict=True)]
    ax.set(xlabel=texts[0], ylabel=fill(texts[1], width=_LABEL))
    for curve in sorted(panel.curves, key=lambda curve: curve.independent):
        x, y = (unit(values) for unit, values in zip(units, (curve.x, curve.y), strict=True))
        if panel.log:
            x, y = scales.positive(x), scales.positive(y)
        label = _label(curve, panel.curves)
        look = looks[label] | _points(curve, panel.curves)
        if np.isfinite(x + y).any():
            ax.plot(x, y, label=label, **look)
    _scale(ax, panel)


def _points(curve: Curve, others: Sequence[Curve]) -> dict[str, Any]:
    """Leave out the markers of many points, and the line through few beside such a curve."""
    if np.size(curve.x) > _FEW:
        return {"marker": ""}
    return {"linestyle": ""} if any(np.size(other.x) > _FEW for other in others) else {}


def _scale(ax: Axes, panel: Panel) -> None:
    """Scale the axes, in decades where the panel asks for them."""
    if not ax.lines:
        ax.set(xticks=[], yticks=[])
        style.remark(ax, "no finite values above zero" if panel.log else "no finite values")
    elif panel.log:
        scales.logarithmic(ax, "x", np.concatenate([line.get_xdata() for line in ax.lines]))
        scales.logarithmic(ax, "y", np.concatenate([line.get_ydata() for line in ax.lines]))
    else:
        scales.linear(ax, "x")
        scales.linear(ax, "y")


def _unit(panel: Panel, axis: str) -> Display:
    """Return the display unit of an axis, by all that is drawn along it."""
    name, units = getattr(panel, axis)
    values: NDArray[np.float64] = np.concatenate(
        [np.ravel(np.asarray(getattr(curve, axis), dtype=float)) for curve in panel.curves]
    )
    return display(xr.DataArray(values, attrs={"units": units}, name=name.replace(" ", "_")))
