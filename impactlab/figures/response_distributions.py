"""Distributions of the responses of a sample."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import access, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, responses, usable

TITLE = "Distributions of the responses"
_BINS = (10, 40)
"""The fewest and the most bins; between them, the square root of the number of runs."""
_FEW = 10
"""Up to so many distinct values there is a bar each."""
_MOSTLY = 0.5
"""From this share of the runs on, one common value would hide the rest."""
_WARNING = style.COLOURS[1]
Values = NDArray[np.float64]


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the runs are a sample."""
    return is_sample(runs) and bool(responses(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown and what is missing."""
    return (
        "Histograms of the responses over the sample. Line: median; shaded: from the 5th to the "
        f"95th percentile.{_jumps(runs)} {access.missing_note(runs, responses(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response; runs without the response are not counted."""
    figure, axes = responses_grid.panels(responses(runs), height=40)
    for name, ax in axes.items():
        values, label = responses_grid.shown(runs, name)
        ax.set_title(label, loc="left")
        _panel(ax, values.values[np.isfinite(values.values)])
    figure.supylabel("Number of runs (–)")
    return figure


def _panel(ax: Axes, values: Values) -> None:
    if values.size == 0 or np.ptp(values) <= responses_grid.ROUND_OFF * np.abs(values).max():
        text = f"constant: {labels.number(float(values[0]))}" if values.size else "no finite values"
        responses_grid.empty(ax, text)
        return
    distinct, counts = np.unique(values, return_counts=True)
    if distinct.size <= _FEW:
        _bars(ax, distinct, counts)
    elif counts.max() >= _MOSTLY * values.size:
        _beside(ax, values, float(distinct[counts.argmax()]))
    else:
        _histogram(ax, values)
    scales.linear(ax, "y")


def _bars(ax: Axes, distinct: Values, counts: NDArray[np.int_]) -> None:
    """A bar a value."""
    width = 0.5 * float(np.diff(distinct).min())
    ax.bar(distinct, counts, width=width, color=style.COLOURS[0], zorder=2)
    scales.at(ax, "x", distinct)


def _beside(ax: Axes, values: Values, common: float) -> None:
    """The histogram of the rest, with the share of the one common value in words."""
    rest = values[values != common]
    ax.hist(rest, bins=_bins(rest), color=style.COLOURS[0], zorder=2)
    share = 100 * (1 - rest.size / values.size)
    text = f"{share:.0f} % of the runs: {labels.number(common)}\n(not drawn)"
    ax.margins(y=0.35)
    ax.text(0.98, 0.98, text, transform=ax.transAxes, ha="right", va="top", color=_WARNING)
    scales.linear(ax, "x")


def _histogram(ax: Axes, values: Values) -> None:
    low, middle, high = np.percentile(values, [5, 50, 95])
    ax.axvspan(low, high, color="0.93", zorder=0)
    ax.hist(values, bins=_bins(values), color=style.COLOURS[0], zorder=2)
    ax.axvline(middle, color=style.COLOURS[1], linewidth=1.0, zorder=3)
    scales.linear(ax, "x")


def _bins(values: Values) -> int:
    return int(np.clip(np.sqrt(values.size), *_BINS))


def _jumps(runs: xr.Dataset) -> str:
    """A sentence on the responses that take few values, or mostly one."""
    found: dict[str, list[str]] = {"few": [], "mostly": []}
    for name in responses(runs):
        values = usable(runs, name).values
        distinct, counts = np.unique(values[np.isfinite(values)], return_counts=True)
        if 1 < distinct.size <= _FEW:
            found["few"].append(labels.response(name))
        elif distinct.size > 1 and counts.max() >= _MOSTLY * counts.sum():
            found["mostly"].append(labels.response(name))
    few = f" Bars, for there are few values: {labels.listing(found['few'])}." * bool(found["few"])
    mostly = f" Mostly one value, drawn without it: {labels.listing(found['mostly'])}."
    return few + mostly * bool(found["mostly"])
