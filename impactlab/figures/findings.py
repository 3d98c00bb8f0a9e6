"""Figures of a verification: the curves of each check."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import labels, responses_grid, scales, style
from impactlab.figures.labels import Display, display
from impactlab.types import Floats
from impactlab.verification.finding import Curve, Outcome, Panel

_FEW = 25  # number of points up to which a curve has markers
_TITLE, _LABEL = 46, 32  # letters per line of a panel's title, and of the label at its side


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
    figure, axes = style.panels(len(panels), columns=2, height=58.0)
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
    count, broken = len(style.COLOURS), style.LINES[1:]
    looks: dict[str, dict[str, Any]] = {}
    for at, label in enumerate(ours):
        looks[label] = {
            "color": style.COLOURS[at % count],
            "linestyle": style.LINES[at // count % len(style.LINES)],
            "linewidth": 1.6,
            "zorder": 3.0 - 0.01 * at,
            # one further each time round, so that no colour has its marker twice
            "marker": style.MARKERS[(at + at // count) % len(style.MARKERS)],
        }
    for at, label in enumerate(independent):
        looks[label] = {
            "color": "black",
            "linestyle": broken[at % len(broken)],
            "linewidth": 0.9,
            "zorder": 4.0,
            "marker": style.MARKERS[at % len(style.MARKERS)],
            "markerfacecolor": "none",
            "markersize": 6.5,
            "markeredgewidth": 0.8,
        }
    return looks


def _label(curve: Curve, others: Sequence[Curve]) -> str:
    """Return the curve's label, changed where the solver's has the same."""
    same = any(curve.label == other.label and not other.independent for other in others)
    return f"{curve.label}, independent" if curve.independent and same else curve.label


def _draw_panel(ax: Axes, panel: Panel, looks: dict[str, dict[str, Any]]) -> None:
    across, up = _unit(panel, "x"), _unit(panel, "y")
    ax.set_title(fill(labels.sentence(panel.title), width=_TITLE), loc="left")
    label = fill(labels.axis(panel.y[0], up.symbol), width=_LABEL)
    ax.set(xlabel=labels.axis(panel.x[0], across.symbol), ylabel=label)
    for curve in sorted(panel.curves, key=lambda curve: curve.independent):
        x, y = across(curve.x), up(curve.y)
        if panel.log:
            x, y = scales.positive(x), scales.positive(y)
        label = _label(curve, panel.curves)
        if np.isfinite(x + y).any():
            ax.plot(x, y, label=label, **(looks[label] | _points(curve, panel.curves)))
    if not ax.lines:
        words = "no finite values above zero" if panel.log else "no finite values"
        responses_grid.empty(ax, words)
    elif panel.log:
        scales.logarithmic(ax, "x", scales.drawn(ax, "x"))
        scales.logarithmic(ax, "y", scales.drawn(ax, "y"))
    else:
        scales.linear(ax, "xy")


def _points(curve: Curve, others: Sequence[Curve]) -> dict[str, Any]:
    """Leave out the markers of many points, and the line through few beside such a curve."""
    if np.size(curve.x) > _FEW:
        return {"marker": ""}
    return {"linestyle": ""} if any(np.size(other.x) > _FEW for other in others) else {}


def _unit(panel: Panel, axis: str) -> Display:
    """Return the display unit of an axis, by all that is drawn along it."""
    name, units = getattr(panel, axis)
    values: Floats = np.concatenate(
        [np.ravel(np.asarray(getattr(curve, axis), dtype=float)) for curve in panel.curves]
    )
    return display(xr.DataArray(values, attrs={"units": units}, name=name.replace(" ", "_")))
