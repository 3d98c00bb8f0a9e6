"""A response against each parameter of a sample, with the conditional mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import access, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, responses, varied
from impactlab.figures.labels import display

Array = NDArray[np.float64]
_SHOWN = 2000
"""Runs that are drawn as points; the mean is of all of them."""
_POINTS: dict[str, Any] = {
    "linestyle": "",
    "marker": ".",
    "markersize": 1.6,
    "markeredgewidth": 0.0,
    "color": "0.6",
}
_BINS, _FEWEST = 20, 30
"""Bins of the mean, at most; runs in a bin, at least."""


@dataclass(frozen=True)
class Scatter:
    """The figure of one response: a panel a parameter."""

    response: str

    @property
    def TITLE(self) -> str:  # noqa: N802  (what every figure's file calls it)
        """Heads the figure."""
        return f"{labels.sentence(labels.response(self.response))} against each parameter"

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Whether the runs are a sample with this response."""
        return is_sample(runs) and self.response in runs and bool(varied(runs))

    def caption(self, runs: xr.Dataset, analysis: xr.Dataset) -> str:
        """What is shown and what is missing."""
        total = runs.sizes["run"]
        points = f"{_SHOWN} of the {total} runs, drawn at random" if total > _SHOWN else "the runs"
        return (
            f"Points: {points}. Line: mean of the response over all runs with about this value of "
            "the parameter; where it is flat, the parameter alone changes nothing. "
            f"{access.missing_note(runs, [self.response])}".strip()
        )

    @style.paper
    def plot(self, runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
        """Points are one picture inside the vector file, or it would have megabytes."""
        names = varied(runs)
        figure, axes = style.panels(len(names), columns=3, height=42, sharey=True)
        values, label = responses_grid.shown(runs, self.response)
        for ax, name in zip(axes, names, strict=True):
            unit = display(runs[name])
            _panel(ax, unit(runs[name].values), values.values)
            ax.set_xlabel(labels.wrapped_axis(labels.parameter(name), unit.symbol))
        if self.response in runs and not np.isfinite(values.values).any():
            for ax in axes:
                style.remark(ax, "no finite values")
        figure.supylabel(label)
        style.legend(figure)
        return figure


def scatters(runs: xr.Dataset) -> dict[str, Scatter]:
    """A figure for each response, by name."""
    return {f"scatter_{name}": Scatter(name) for name in responses(runs)}


def conditional_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Means of x and y in bins of x that hold as many runs each; x, y: (runs,), finite.

    Runs with one and the same x are never parted.
    """
    bins = int(np.clip(x.size // _FEWEST, 1, _BINS))
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, bins + 1)[1:-1]))
    place = np.searchsorted(edges, x, side="right")
    count = np.bincount(place)
    held = count > 0
    means = [np.bincount(place, weights=values)[held] / count[held] for values in (x, y)]
    return means[0], means[1]


def _panel(ax: Axes, x: Array, y: Array) -> None:
    finite = np.isfinite(x) & np.isfinite(y)
    x, y = x[finite], y[finite]
    if not x.size:
        return
    some = np.random.default_rng(1).permutation(x.size)[:_SHOWN]  # a sample's order has structure
    ax.plot(x[some], y[some], label="_runs", rasterized=True, **_POINTS)
    middle, mean = conditional_mean(x, y)
    ax.plot(middle, mean, label="conditional mean", color=style.COLOURS[1], linewidth=1.5)
    scales.linear(ax, "x", 4)
    scales.linear(ax, "y", 4)
