"""Displacements of sphere and beam, and the indentation, against time."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.labels import Display, display

TITLE = "Displacements against time"
_CURVES = {
    "sphere_displacement": "sphere",
    "midspan_deflection": "beam at mid-span",
    "indentation": "indentation",
}

_WIDE = 3


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept histories, of no more contact laws than panels fit side by side."""
    kept = all(name in runs for name in _CURVES)
    return kept and len(curves.chosen(runs, next(iter(_CURVES))).panels) <= _WIDE


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    names = list(_CURVES)
    return (
        "Displacement of the sphere since first touch, deflection of the beam at mid-span, and "
        "their difference, the indentation (below zero: the two are apart); downwards is positive. "
        f"{curves.note(runs, names[0])} {access.missing_note(runs, names)}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a run, a column a contact law."""
    selected = curves.chosen(runs, next(iter(_CURVES)))
    shown = [(panel, curve) for curve in selected.curves for panel in selected.panels]
    columns = len(selected.panels) if len(selected.panels) > 1 else min(len(shown), 2)
    figure, axes = style.panels(len(shown), columns=columns, height=45, sharex=True)
    unit = display(runs["midspan_deflection"])
    for ax, (panel, curve) in zip(axes, shown, strict=True):
        texts = (labels.sentence(panel.label), curve.label)
        ax.set_title(", ".join(filter(None, texts)), loc="left")
        _draw(ax, runs, selected.runs(panel, curve), unit)
    figure.supylabel(labels.axis("displacement", unit.symbol))
    figure.supxlabel(labels.axis("time since first touch", display(runs["time"]).symbol))
    style.legend(figure, order=list(_CURVES.values()))
    return figure


def _draw(ax: Axes, runs: xr.Dataset, where: dict[str, int], unit: Display) -> None:
    scales.linear(ax, "x")
    scales.linear(ax, "y")
    time = display(runs["time"])(runs["time"])
    for at, (name, label) in enumerate(_CURVES.items()):
        values = usable(runs, name).isel(where)
        if np.isfinite(values).any():
            ax.plot(
                time, unit(values), label=label, color=style.COLOURS[at], linestyle=style.LINES[at]
            )
    if not ax.lines:
        style.remark(ax, "no finite values")
        return
    ax.set_xlim(0.0, float(time[-1]))
    ax.axhline(0.0, label="_guide", linestyle="-", **style.GUIDE)
