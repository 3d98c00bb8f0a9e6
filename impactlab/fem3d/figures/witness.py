"""The beam models and the 3-D FE model against velocity, and their differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.fem3d.figures import differences
from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.labels import display

TITLE = "The beam models and the 3-D FE model"
_NAMES = (
    *("peak_force", "contact_duration", "maximum_deflection"),
    *("permanent_indentation", "maximum_indentation"),
)
"""Responses to draw, most important first."""
_MOST = 3
_LEAST, _ROOM = 2.0, 2.0
"""Least half-height of a panel of differences in %; its largest, over the largest difference."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether a grid has the 3-D FE model beside others, and a response to draw."""
    return differences.differ(runs) and bool(_drawn(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return the caption, with the number of missing runs."""
    return (
        "Above: each model on its finest grid. Below: its difference from the 3-D "
        "finite-element model, in parts of that; bars: the numerical uncertainty of both models "
        "together, left out where nothing bounds it and cut at the panel's edge. Markers are "
        "shifted sideways a little. "
        f"{access.missing_note(runs, _drawn(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw one column per response: values above, differences from the 3-D FE model below."""
    names = _drawn(runs)
    figure, axes = style.panels(2 * len(names), columns=len(names), height=52)
    for at, name in enumerate(names):
        above, below = axes[at], axes[at + len(names)]
        _values(above, runs, analysis, name)
        _differences(below, runs, analysis, name)
        for ax in (above, below):
            scales.logarithmic(ax, "x", runs["velocity"].values)
            scales.at(ax, "x", runs["velocity"].values)
        below.set_xlabel(labels.axis(labels.parameter("velocity"), "m/s"))
    axes[len(names)].set_ylabel(labels.wrapped_axis("difference from the 3-D FE model", "%", 24))
    style.legend(
        figure,
        "Model of the beam",
        [differences.label(model) for model in differences.models(runs)],
    )
    return figure


def _drawn(runs: xr.Dataset) -> list[str]:
    return [name for name in _NAMES if name in differences.compared_responses(runs)][:_MOST]


def _look(at: int) -> dict[str, Any]:
    """Return the style: 3-D black, others as in all figures, one marker each."""
    colour = "black" if at == 0 else style.COLOURS[at - 1]
    return {"color": colour, "marker": style.MARKERS[at], "linestyle": style.LINES[at]}


def _values(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    unit = display(usable(runs, name).rename(name).assign_attrs(runs[name].attrs))
    for at, model in enumerate(differences.models(runs)):
        values = unit(differences.side(runs, analysis, name, model).value)
        if np.isfinite(values).any():
            ax.plot(runs["velocity"].values, values, label=differences.label(model), **_look(at))
    ax.set_title(labels.sentence(labels.response(name)), loc="left")
    ax.set_ylabel(labels.axis(labels.response(name), unit.symbol))
    if not ax.lines:
        style.remark(ax, "no finite values")
        return
    shown = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    if np.nanmin(shown) > 0:
        scales.logarithmic(ax, "y", shown)


def _differences(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    first, *others = differences.models(runs)
    against = differences.side(runs, analysis, name, first)
    speeds = runs["velocity"].values
    for at, model in enumerate(others, 1):
        gap = differences.difference([differences.side(runs, analysis, name, model)], [against])
        bars = np.where(np.isfinite(gap.uncertainty), 100.0 * gap.uncertainty, np.nan)
        shift = 1.0 + 0.04 * (at - 0.5 * (len(others) + 1))
        if np.isfinite(gap.value).any():
            look = _look(at) | {"label": differences.label(model)}
            ax.errorbar(shift * speeds, 100.0 * gap.value, yerr=bars, elinewidth=0.8, **look)
    if not ax.containers:
        style.remark(ax, "no finite values")
        return
    ax.axhline(0.0, label="_guide", **style.GUIDE)
    scales.linear(ax, "y")
    largest = max(_LEAST, *(np.nanmax(abs(np.asarray(line.get_ydata()))) for line in ax.lines))
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, -_ROOM * largest), min(high, _ROOM * largest))
