"""Sobol indices of first and total order."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import responses_grid, scales, style
from impactlab.figures.reading import missing, verdicts, words
from impactlab.figures.reading.contents import known, responses

TITLE = "Sobol indices"
_ORDERS = (("first_order", "first order", -0.19), ("total_order", "total order", 0.19))
_WIDTH = 0.36


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the analysis has indices, for responses of these runs."""
    return all(name in analysis for name, _, _ in _ORDERS) and bool(names(runs, analysis))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown and what is missing."""
    return (
        "Share of the variance of each response that comes from a parameter alone (first order) "
        "and with all its interactions (total order), over the ranges of this study; lines are "
        f"{verdicts.confidence(analysis)} intervals. "
        f"{missing.note(runs, names(runs, analysis))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a pair of bars a parameter."""
    shown = names(runs, analysis)
    parameters = [str(name) for name in analysis["parameter"].values]
    figure, axes = responses_grid.panels(shown, height=10 + 4.2 * len(parameters))
    for at, (name, ax) in enumerate(axes.items()):
        _bars(ax, analysis.sel(response=name))
        undefined(ax, analysis, name)
        _rows(ax, parameters if at % responses_grid.COLUMNS == 0 else [""] * len(parameters))
    figure.supxlabel("Share of the variance (–)")
    style.legend(figure)
    return figure


def names(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """The responses that the sensitivity analysis knows."""
    return [name for name in responses(runs) if known(analysis, name)]


def undefined(ax: Axes, analysis: xr.Dataset, name: str) -> None:
    """Say in the panel why a response has no indices, or that they need care."""
    found = verdicts.verdict(analysis, "sensitivity_verdict", name)
    why = found.words if found else "no reason is given"
    if not bool(np.isfinite(analysis["first_order"].sel(response=name)).any()):
        style.remark(ax, f"undefined:\n{why}")
    elif found and not found.sound:
        responses_grid.write_verdict(ax, analysis, "sensitivity_verdict", name)


def _bars(ax: Axes, indices: xr.Dataset) -> None:
    rows = np.arange(indices.sizes["parameter"])
    for (name, label, shift), colour in zip(_ORDERS, style.COLOURS, strict=False):
        values = indices[name].values
        interval = indices.get(f"{name}_interval")
        ax.barh(
            rows + shift,
            values,
            height=_WIDTH,
            color=colour,
            label=label,
            xerr=None if interval is None else interval.values,
            error_kw={"elinewidth": 0.8, "ecolor": "0.15"},
        )
    ax.axvline(0.0, color="0.15", linewidth=0.6)


def _rows(ax: Axes, labels: list[str]) -> None:
    """Parameters from top to bottom; the axis always holds 0 to 1."""
    ax.set_yticks(range(len(labels)), [words.parameter(label) if label else "" for label in labels])
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")
    ax.set_ylim(len(labels) - 0.5, -0.5)
    low, high = ax.get_xlim()
    ax.set_xlim(min(low, 0.0), max(high, 1.0))
    scales.linear(ax, "x")
