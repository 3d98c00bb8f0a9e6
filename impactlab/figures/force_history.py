"""Contact force against time, all sub-impacts."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Choice
from impactlab.figures.labels import display

TITLE = "Contact force against time"
_FORCE = "contact_force"
_FEW, _MANY = 32.0, 21.0
"""Height of a row of few or many, mm."""
_WIDE = 3
"""Up to so many columns a panel's title has room on one line."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept histories."""
    return _FORCE in runs


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Contact force from first touch to the end of the last contact; each panel has a scale of "
        "force of its own, and a peak after a gap is a sub-impact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a run, for sub-impacts of many runs would hide each other: a column a contact law."""
    selected, force = curves.chosen(runs, _FORCE), usable(runs, _FORCE)
    shown = [(panel, curve) for curve in selected.curves for panel in selected.panels]
    height = _FEW if len(shown) <= 3 * len(selected.panels) else _MANY
    figure, axes = style.panels(
        len(shown), columns=len(selected.panels), height=height, sharex=True
    )
    between = ", " if len(selected.panels) <= _WIDE else "\n"
    for ax, (panel, curve) in zip(axes, shown, strict=True):
        texts = (labels.sentence(panel.label), curve.label)
        ax.set_title(between.join(filter(None, texts)), loc="left")
        _draw(ax, force.isel(selected.runs(panel, curve)), runs, curve)
    units = display(runs[_FORCE]).symbol, display(runs["time"]).symbol
    figure.supylabel(labels.axis("contact force", units[0]))
    figure.supxlabel(labels.axis("time since first touch", units[1]))
    axes[0].set_xlim(0.0, 1.02 * _end(axes) or None)
    return figure


def _draw(ax: Axes, force: xr.DataArray, runs: xr.Dataset, curve: Choice) -> None:
    scales.linear(ax, "x")
    scales.linear(ax, "y", ticks=3)
    if np.isfinite(force).any():
        time, unit = display(runs["time"]), display(runs[_FORCE])
        look = curves.look(curve) | {"linestyle": "-", "linewidth": 0.9}
        ax.plot(time(runs["time"]), unit(force), label=curve.label or "_only", **look)
        ax.set_ylim(0.0, None)
    else:
        style.remark(ax, "no finite values")


def _end(axes: list[Axes]) -> float:
    """The last time in contact over all panels."""
    last = 0.0
    for line in (line for ax in axes for line in ax.lines):
        inside = np.flatnonzero(np.asarray(line.get_ydata()) > 0)
        if inside.size:
            last = max(last, float(np.asarray(line.get_xdata())[inside[-1]]))
    return last
