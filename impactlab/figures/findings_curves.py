"""The curves of one check: the solver's beside the independent ones."""

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

_COLUMNS = 2
_HEIGHT = 58.0
"""Of a panel, mm."""
_FEW = 25
"""Curves of up to so many points have markers."""
_TITLE, _LABEL = 46, 32
"""Letters of a panel's title, and of the label at its side, before they are broken."""


def applies(outcome: Outcome) -> bool:
    """Whether the check gave curves."""
    return any(panel.curves for panel in outcome.finding.panels)


def caption(outcome: Outcome) -> str:
    """How to tell the curves apart."""
    return (
        "Coloured lines or filled markers: the solver. Black broken lines or open markers: "
        f"independent ({outcome.source})."
    )


@style.paper
def plot(outcome: Outcome) -> Figure:
    """A panel a panel, in two columns; one legend for all where it is the same in all."""
    panels = [panel for panel in outcome.finding.panels if panel.curves]
    figure, axes = style.panels(len(panels), columns=_COLUMNS, height=_HEIGHT)
    looks = [_looks(panel) for panel in panels]
    for ax, panel, look in zip(axes, panels, looks, strict=True):
        _draw(ax, panel, look)
    if all(look == looks[0] for look in looks):
        style.legend(figure, order=list(looks[0]))
    else:
        style.panel_legends(figure)
    return figure


def _looks(panel: Panel) -> dict[str, dict[str, Any]]:
    """By label: ours first, coloured; then independent ones, black and broken."""
    ours, independent = (
        dict.fromkeys(_label(c, panel.curves) for c in panel.curves if c.independent == kind)
        for kind in (False, True)
    )
    looks = {label: _coloured(at) for at, label in enumerate(ours)}
    return looks | {label: _broken(at) for at, label in enumerate(independent)}


def _label(curve: Curve, others: Sequence[Curve]) -> str:
    """The curve's own, or one that tells it from the solver's of the same name."""
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


def _draw(ax: Axes, panel: Panel, looks: dict[str, dict[str, Any]]) -> None:
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
    """No markers on a curve of many points, no line through few beside such a curve."""
    if np.size(curve.x) > _FEW:
        return {"marker": ""}
    return {"linestyle": ""} if any(np.size(other.x) > _FEW for other in others) else {}


def _scale(ax: Axes, panel: Panel) -> None:
    """Decades where the panel asks for them."""
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
    """The display unit of an axis, by all that is drawn along it."""
    name, units = getattr(panel, axis)
    values: NDArray[np.float64] = np.concatenate(
        [np.ravel(np.asarray(getattr(curve, axis), dtype=float)) for curve in panel.curves]
    )
    return display(xr.DataArray(values, attrs={"units": units}, name=name.replace(" ", "_")))
