"""Convergence of the responses as the nodes get closer."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import curves, responses_grid, scales, style
from impactlab.figures.reading import missing, words
from impactlab.figures.reading.contents import known, responses, usable
from impactlab.figures.reading.plan import Plan, plan
from impactlab.figures.reading.units import display

TITLE = "Convergence in nodes"
_FEWEST = 3


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the grid has at least three numbers of nodes."""
    return runs.sizes.get("nodes", 0) >= _FEWEST and bool(_names(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Difference to the value extrapolated to zero spacing (Richardson), or where there is none "
        "to that of the most nodes, relative to it, against the spacing of the nodes. Grey: second "
        "order. A verdict is the worst over the whole grid, also over what is not drawn. "
        f"{_plan(runs).note(runs)} {missing.note(runs, _names(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    selected, (spacing, label) = _plan(runs), _spacing(runs)
    figure, axes = responses_grid.panels(_names(runs), height=40)
    for name, ax in axes.items():
        responses_grid.write_verdict(ax, analysis, "nodes_summary", name)
        difference = _difference(runs, analysis, name)
        for curve in selected.curves:
            values = scales.positive(
                difference.isel(selected.held | curve.where), above=responses_grid.ROUND_OFF
            )
            if np.isfinite(values).any():
                ax.plot(spacing, values, label=curve.label or "_only", **curves.marked(curve))
        _finish(ax, spacing, difference)
    figure.supxlabel(label)
    figure.supylabel("Relative difference (–)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _names(runs: xr.Dataset) -> list[str]:
    return [name for name in responses(runs) if "nodes" in runs[name].dims]


def _plan(runs: xr.Dataset) -> Plan:
    return plan(runs, _names(runs)[0], along=["nodes"], prefer=["velocity", "points"])


def _difference(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> xr.DataArray:
    """|f - f0|/|f0| with f0 Richardson's value, or else the finest grid's; NaN where f0 is 0."""
    values = usable(runs, name)
    finest = values.isel(nodes=int(np.argmax(values["nodes"].values)), drop=True)
    reference = finest
    if "nodes_extrapolated" in analysis and known(analysis, name):
        limit = analysis["nodes_extrapolated"].sel(response=name, drop=True)
        reference = limit.where(np.isfinite(limit), finest)
    ratio = abs(values - reference) / abs(reference).where(reference != 0)
    return ratio.where((values != 0) | (reference != 0), 0.0).transpose("nodes", ...)


def _spacing(runs: xr.Dataset) -> tuple[NDArray[np.float64], str]:
    """The spacing of the nodes with its label; over the span where the span is varied."""
    relative = 1.0 / (runs["nodes"].values - 1.0)
    if runs["beam_span"].ndim:
        return relative, "Spacing of the nodes over the span (–)"
    spacing = (runs["beam_span"] * xr.DataArray(relative)).assign_attrs(units="m").rename("spacing")
    unit = display(spacing)
    return unit(spacing), words.axis("spacing of the nodes", unit.symbol)


def _finish(ax: Axes, spacing: NDArray[np.float64], difference: xr.DataArray) -> None:
    """Logarithmic axes and a guide of second order above all that is drawn."""
    if not ax.lines:
        enough = bool((difference.count("nodes") > 1).any())
        responses_grid.empty(ax, "same at every spacing" if enough else "too few values")
        return
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    ends = np.array([spacing.min(), spacing.max()])
    guide = 1.6 * np.nanmax(drawn) * (ends / ends[1]) ** 2
    ax.plot(ends, guide, label="_guide", linestyle="-", **style.GUIDE)
    scales.logarithmic(ax, "x", spacing)
    scales.logarithmic(ax, "y", [*drawn, *guide])
    if spacing.size <= 5:
        scales.at(ax, "x", spacing)
    ax.set_xlim(0.85 * ends[0], 1.18 * ends[1])
