"""Error of the responses with the number of integration points."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, responses_grid, scales, style
from impactlab.figures.access import known, responses
from impactlab.figures.curves import Plan, plan

TITLE = "Convergence in integration points"
_TOLERANCE = 1.0
"""The error that the analysis asks for, in %."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the analysis has errors in points, for responses of these runs."""
    return "points_error" in analysis and "points" in runs.dims and bool(_names(runs, analysis))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    names = _names(runs, analysis)
    return (
        "Difference to the value with the most integration points over the depth (which is left "
        f"out, being its own reference), relative to it. Grey: {_TOLERANCE:g} %. A verdict is the "
        "worst over the whole grid, also over what is not drawn. "
        f"{_plan(runs, names).note(runs)} {access.missing_note(runs, names)}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve a rule (and velocity)."""
    names = _names(runs, analysis)
    selected, points = _plan(runs, names), analysis["points"].values
    figure, axes = responses_grid.panels(names, height=40)
    for name, ax in axes.items():
        responses_grid.write_verdict(ax, analysis, "points_summary", name)
        error = 100.0 * abs(analysis["points_error"].sel(response=name)).transpose("points", ...)
        for curve in selected.curves:
            values = scales.positive(
                error.isel(selected.held | curve.where), above=100 * responses_grid.ROUND_OFF
            )
            if np.isfinite(values).any():
                ax.plot(points, values, label=curve.label or "_only", **curves.marked(curve))
        _finish(ax, points, error)
    figure.supxlabel(labels.axis(labels.parameter("points"), ""))
    figure.supylabel("Error (%)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _names(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    named = (name for name in responses(runs) if known(analysis, name))
    return [name for name in named if "points" in runs[name].dims]


def _plan(runs: xr.Dataset, names: list[str]) -> Plan:
    return plan(runs, names[0], along=["points"], prefer=["rule", "velocity"])


def _finish(ax: Axes, points: np.ndarray, error: xr.DataArray) -> None:
    """Points as they are, errors logarithmic."""
    if not ax.lines:
        enough = bool((error.count("points") > 1).any())
        responses_grid.empty(ax, "same for every number" if enough else "too few values")
        return
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    scales.logarithmic(ax, "x", points)
    scales.at(ax, "x", points)
    scales.logarithmic(ax, "y", [*drawn, _TOLERANCE])
    ax.set_xlim(0.9 * points.min(), 1.1 * points.max())
    ax.axhline(_TOLERANCE, label="_guide", linestyle="--", **style.GUIDE)
