"""Distributions of the responses of a sample."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import responses_grid, scales, style
from impactlab.figures.reading import missing, words
from impactlab.figures.reading.contents import is_sample, responses

TITLE = "Distributions of the responses"
_BINS = (10, 40)
"""The fewest and the most bins; between them, the square root of the number of runs."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the runs are a sample."""
    return is_sample(runs) and bool(responses(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown and what is missing."""
    return (
        "Histograms of the responses over the sample. Line: median; shaded: from the 5th to the "
        f"95th percentile. {missing.note(runs, responses(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response; runs without the response are not counted."""
    figure, axes = responses_grid.panels(responses(runs), height=38)
    for name, ax in axes.items():
        values, label = responses_grid.shown(runs, name)
        ax.set_title(label, loc="left")
        _histogram(ax, values.values[np.isfinite(values.values)])
    figure.supylabel("Number of runs (–)")
    return figure


def _histogram(ax: Axes, values: NDArray[np.float64]) -> None:
    if values.size == 0 or np.ptp(values) <= 1e-9 * np.abs(values).max():
        text = f"constant: {words.number(float(values[0]))}" if values.size else "no finite values"
        responses_grid.empty(ax, text)
        return
    low, middle, high = np.percentile(values, [5, 50, 95])
    ax.axvspan(low, high, color="0.93", zorder=0)
    ax.hist(values, bins=_edges(values), color=style.COLOURS[0], zorder=2)
    ax.axvline(middle, color=style.COLOURS[1], linewidth=1.0, zorder=3)
    scales.linear(ax, "x")
    scales.linear(ax, "y")


def _edges(values: NDArray[np.float64]) -> list[float]:
    """A bin a whole number for counts over a short range, else even bins."""
    low, high = float(values.min()), float(values.max())
    if high - low < _BINS[1] and not np.any(values % 1):
        return [float(edge) for edge in np.arange(low - 0.5, high + 1.0)]
    bins = int(np.clip(np.sqrt(values.size), *_BINS))
    return [float(edge) for edge in np.linspace(low, high, bins + 1)]
