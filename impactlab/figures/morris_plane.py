"""The plane of Morris: how strongly a response moves with a parameter, and how evenly.

Morris (1991), Technometrics 33, 161; µ* after Campolongo et al. (2007), Environ. Modell. Softw. 22.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, labels, measures, responses_grid, scales, style
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, asked

TITLE = MORRIS.title
_SLOPES = ((1.0, "σ = µ*"), (0.1, "σ = 0.1 µ*"))


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the analysis has the mean magnitudes and the spread of elementary effects."""
    return (
        "morris_mu_star" in analysis and "morris_sigma" in analysis and bool(asked(runs, analysis))
    )


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, how to read it and what is missing."""
    return (
        f"{MORRIS.says} Above σ = µ* an effect changes its size or sign with the others or along "
        "the range; below σ = 0.1 µ* it is nearly linear and additive. Lines: "
        f"{access.confidence(analysis)} intervals of µ*. "
        f"{access.missing_note(runs, asked(runs, analysis))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a marker a parameter."""
    figure, axes = responses_grid.panels(asked(runs, analysis), height=48)
    for name, ax in axes.items():
        _plane(ax, runs, analysis, name)
    style.legend(figure)
    return figure


def _plane(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, response: str) -> None:
    strength = measures.index(analysis, "morris_mu_star", response)
    spread = analysis["morris_sigma"].sel(response=response).values
    effects = xr.DataArray(strength.values, attrs=runs[response].attrs, name=response)
    unit = display(effects)
    x, y, margin = unit(strength.values), unit(spread), unit(strength.margins)
    for at, name in enumerate(measures.parameters(analysis)):
        if np.isfinite(x[at]):
            ax.errorbar(
                x[at],
                y[at],
                xerr=margin[at] if np.isfinite(margin[at]) else None,
                label=labels.parameter(name),
                elinewidth=0.8,
                **(style.told_apart(at) | {"linestyle": ""}),
            )
    responses_grid.warn(ax, analysis, "sensitivity_verdict", response)
    if not ax.lines:
        responses_grid.empty(ax, "no finite values")
        return
    ax.set(xlabel=labels.axis("mean µ*", unit.symbol), ylabel=labels.axis("spread σ", unit.symbol))
    _guides(ax, right=float(np.nanmax(x + np.nan_to_num(margin, posinf=0.0))), top=np.nanmax(y))


def _guides(ax: Axes, right: float, top: float) -> None:
    ax.set(xlim=(0.0, 1.1 * right or 1.0), ylim=(0.0, 1.15 * max(top, 0.12 * right) or 1.0))
    for slope, text in _SLOPES:
        ax.axline((0.0, 0.0), slope=slope, label="_guide", **style.GUIDE)
        x = min(0.97 * ax.get_xlim()[1], 0.9 * ax.get_ylim()[1] / slope)
        ax.text(x, slope * x, text, fontsize=6, color=style.MUTED, ha="right", va="bottom")
    scales.linear(ax, "x")
    scales.linear(ax, "y")
