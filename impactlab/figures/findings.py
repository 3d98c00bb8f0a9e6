"""Figures of a verification: all comparisons on one axis, and the curves of each check."""

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import labels, scales, style
from impactlab.figures.data import name_places
from impactlab.figures.labels import Display, display
from impactlab.types import Floats
from impactlab.verification.finding import Curve, CurvePanel, Outcome

_ROW = 8.0  # height of a check's row, mm
_LEAST, _MOST = 1e-6, 1e3  # limits of the ratios; those beyond are drawn at the edge
_SPREAD = 0.32  # largest distance of points from the middle of their row, in rows
_LETTERS = 34
_LOOKS: dict[str, dict[str, Any]] = {
    "passed": {"marker": "o", "color": style.COLOURS[0], "alpha": 0.7},
    "failed": {"marker": "X", "color": style.COLOURS[1], "markersize": 6.0},
}
_FEW = 25  # number of points up to which a curve has markers
_TITLE, _LABEL = 92, 32  # letters of the titles of a row, and per line of the label at a side
_MANY = 6  # largest number of panels in two columns


def overview_caption(outcomes: Sequence[Outcome]) -> str:
    """Return the caption, with the numbers of points at the edges."""
    ratios = np.concatenate([_ratios(outcome) for outcome in outcomes])
    small = int(np.count_nonzero(ratios < _LEAST))
    large = int(np.count_nonzero(ratios > _MOST))
    left = f"{small} below {labels.number(_LEAST)} or without any error at the left edge"
    right = f"{large} above {labels.number(_MOST)} or without a number at the right edge"
    edges = [text for count, text in ((small, left), (large, right)) if count]
    shown = f" Drawn as triangles: {labels.listing(edges)}." if edges else ""
    return (
        "Error over tolerance, a point per comparison and a row per check; right of the line at "
        f"1 a comparison fails. Within a row, points are spread in the order of the "
        f"comparisons.{shown}"
    )


@style.paper
def plot_overview(outcomes: Sequence[Outcome]) -> Figure:
    """Draw a row per check, the first on top; failed comparisons have a shape of their own."""
    height = 18.0 + _ROW * len(outcomes)
    figure, (axes,) = style.panels(1, columns=1, height=height, width=style.DOUBLE)
    for row, outcome in enumerate(outcomes):
        _draw_row(axes, row, outcome)
    axes.axvline(1.0, label="_limit", **style.GUIDE)
    largest = max((float(_ratios(outcome).max(initial=0.0)) for outcome in outcomes), default=0.0)
    ratios = np.clip(np.concatenate([*map(_ratios, outcomes), [0.01]]), _LEAST, _MOST)
    least = 10.0 ** np.floor(np.log10(ratios.min()))  # the decade below all that is drawn
    limits = 0.6 * float(least), 2.5 * min(max(largest, 4.0), _MOST)
    scales.logarithmic(axes, "x", limits, ticks=8)
    axes.set(xlim=limits, ylim=(len(outcomes) - 0.5, -0.5), xlabel="Error over tolerance (–)")
    name_places(axes, "y", [fill(outcome.title, _LETTERS) for outcome in outcomes])
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    for row in range(1, len(outcomes)):
        axes.axhline(row - 0.5, color="0.85", linewidth=0.5)
    return style.finish(figure, order=["passed", "failed"])


def _draw_row(axes: Axes, row: int, outcome: Outcome) -> None:
    """Draw the ratios of a check, triangles at the edges, and write to the right how many fail."""
    ratios = _ratios(outcome)
    places = row + np.linspace(-_SPREAD, _SPREAD, ratios.size) if ratios.size > 1 else row
    y = np.broadcast_to(places, ratios.shape)
    passed = np.array([entry.passed for entry in outcome.finding.comparisons], dtype=bool)
    shown = np.clip(ratios, _LEAST, _MOST)
    kinds = {  # by marker
        "<": ratios < _LEAST,
        ">": ratios > _MOST,
        "": (ratios >= _LEAST) & (ratios <= _MOST),
    }
    for verdict, chosen in (("passed", passed), ("failed", ~passed)):
        for marker, where in kinds.items():
            if not (mask := chosen & where).any():
                continue
            look = _LOOKS[verdict] | ({"marker": marker} if marker else {})
            label = f"_data: {verdict}" if marker else verdict
            axes.plot(shown[mask], y[mask], linestyle="", markeredgewidth=0.0, label=label, **look)
    total, failed = len(outcome.finding.comparisons), len(outcome.failures)
    text = f"{failed} of {total} failed" if failed else f"all {total}"
    if outcome.verdict == "error" or not total:
        text, failed = ("error" if outcome.reason else "nothing"), 1
    beside = {"xycoords": axes.get_yaxis_transform(), "va": "center"}
    style.note(axes, text, (1.0, row), (3, 0), warning=bool(failed), **beside)


def _ratios(outcome: Outcome) -> Floats:
    return np.array([entry.ratio for entry in outcome.finding.comparisons], dtype=float)


def curves_caption(outcome: Outcome) -> str:
    """Return the caption, which tells the two kinds of curves apart."""
    return (
        "Coloured lines or filled markers: the solver. Broad grey lines or open black markers: "
        f"independent ({outcome.source})."
    )


@style.paper
def plot_curves(outcome: Outcome) -> Figure:
    """Draw the check's panels, with one legend."""
    panels = [panel for panel in outcome.finding.panels if panel.curves]
    columns = 3 if len(panels) == 3 or len(panels) > _MANY else 2
    figure, axes = style.panels(len(panels), columns=columns, height=58.0)
    looks = _looks(panels)
    for ax, panel in zip(axes, panels, strict=True):
        _draw_panel(ax, panel, looks, columns)
    style.legend(figure, order=list(looks))
    return figure


def _looks(panels: Sequence[CurvePanel]) -> dict[str, dict[str, Any]]:
    """Return the looks by label: the solver's coloured, then independent ones grey and broad."""
    ours, independent = (
        dict.fromkeys(
            _label(curve, panel.curves)
            for panel in panels
            for curve in panel.curves
            if curve.independent == kind
        )
        for kind in (False, True)
    )
    count = len(style.COLOURS)
    looks: dict[str, dict[str, Any]] = {}
    for number, label in enumerate(ours):
        looks[label] = {
            "color": style.COLOURS[number % count],
            "linestyle": style.LINES[number // count % len(style.LINES)],
            "linewidth": 1.2,
            "zorder": 3.0 - 0.01 * number,
            # one further each time round, so that no colour has its marker twice
            "marker": style.MARKERS[(number + number // count) % len(style.MARKERS)],
        }
    for number, label in enumerate(independent):
        looks[label] = {
            "color": "0.72",
            "linestyle": style.LINES[number % len(style.LINES)],
            "linewidth": 2.8,
            "zorder": 2.0,  # beneath the colours
            "marker": style.MARKERS[number % len(style.MARKERS)],
            "markerfacecolor": "none",
            "markeredgecolor": "black",
            "markersize": 6.5,
            "markeredgewidth": 0.8,
        }
    return looks


def _label(curve: Curve, curves: Sequence[Curve]) -> str:
    """Return the curve's label, changed where the solver's has the same."""
    same = any(curve.label == other.label and not other.independent for other in curves)
    return f"{curve.label}, independent" if curve.independent and same else curve.label


def _draw_panel(
    ax: Axes, panel: CurvePanel, looks: dict[str, dict[str, Any]], columns: int
) -> None:
    across, up = _unit(panel, "x"), _unit(panel, "y")
    ax.set_title(fill(labels.sentence(panel.title), width=_TITLE // columns), loc="left")
    ax.set_xlabel(labels.wrapped_axis(panel.x[0], across.symbol, _LABEL))
    ax.set_ylabel(labels.wrapped_axis(panel.y[0], up.symbol, _LABEL))
    for curve in sorted(panel.curves, key=lambda curve: curve.independent):
        x, y = across(curve.x), up(curve.y)
        if panel.log:
            x, y = scales.positive(x), scales.positive(y)
        label = _label(curve, panel.curves)
        if np.isfinite(x + y).any():
            ax.plot(x, y, label=label, **(looks[label] | _points(curve, panel.curves)))
    if not ax.lines:
        text = "no finite values above zero" if panel.log else "no finite values"
        style.empty(ax, text)
    elif panel.log:
        scales.logarithmic(ax, "x", scales.drawn(ax, "x"))
        scales.logarithmic(ax, "y", scales.drawn(ax, "y"))
    else:
        scales.linear(ax, "xy")


def _points(curve: Curve, curves: Sequence[Curve]) -> dict[str, Any]:
    """Leave out the markers of many points, and the line through few beside such a curve."""
    if np.size(curve.x) > _FEW:
        return {"marker": ""}
    return {"linestyle": ""} if any(np.size(other.x) > _FEW for other in curves) else {}


def _unit(panel: CurvePanel, axis: str) -> Display:
    """Return the display unit of an axis, by all that is drawn along it."""
    name, units = getattr(panel, axis)
    values: Floats = np.concatenate(
        [np.ravel(np.asarray(getattr(curve, axis), dtype=float)) for curve in panel.curves]
    )
    return display(xr.DataArray(values, attrs={"units": units}, name=name.replace(" ", "_")))
