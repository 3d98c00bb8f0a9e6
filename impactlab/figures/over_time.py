"""Sobol indices of histories against time, above the mean history with its band."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, labels, record, scales, style
from impactlab.figures.labels import Display, display
from impactlab.figures.measures import parameters
from impactlab.variables import status_bits

_ORDERS = {"first_order_over_time": "first order", "total_order_over_time": "total order"}
_ENDS = (-0.25, 1.25)  # largest limits of an axis of indices
VERDICT = "history_verdict"


def shown(analysis: xr.Dataset) -> list[str]:
    """Return the histories that the analysis has indices of."""
    given = all(name in analysis for name in (*_ORDERS, "history_mean", VERDICT))
    return [str(name) for name in analysis["history"].values] if given else []


def _sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
    failed = (runs["status"] & status_bits([])) != 0  # no history is read
    return (
        f"Bands of the indices: {access.confidence(analysis)} intervals, cut off outside "
        "−0.25 to 1.25; of the mean: one standard deviation to either side.",
        "Gaps: times at which all runs, or all but a few, have the same value.",
        access.missing_words(runs, failed, "here, and all others of their base samples"),
    )


@record.figure(
    "Sobol indices over time",
    "Share of the variance at each time that comes from a parameter alone (first order) and with "
    "all its interactions (total order). Beneath: the mean of the runs, whose spread tells where "
    "there is a variance worth explaining.",
    lambda runs, analysis: bool(shown(analysis)),
    _sentences,
)
def indices_over_time(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a column per history: first order, total order and mean, one beneath the other."""
    names = shown(analysis)
    words = [labels.sentence(labels.response(name)) for name in names]
    titles = [f"{word}, {order}" for order in _ORDERS.values() for word in words]
    titles += [f"{word}, mean" for word in words]
    figure, axes = style.titled_panels(titles, columns=len(names), height=38, sharex=True)
    time = display(analysis["time"])
    for row, order in enumerate(_ORDERS):
        for at, name in enumerate(names):
            _indices(axes[row * len(names) + at], analysis.sel(history=name), order, time)
    for ax, name in zip(axes[-len(names) :], names, strict=True):
        _mean(ax, analysis.sel(history=name), time)
    figure.supxlabel(labels.axis("time since first touch", time.symbol))
    style.legend(figure)
    return figure


def _indices(ax: Axes, found: xr.Dataset, order: str, time: Display) -> None:
    """Draw a line with its band per parameter; gaps where there is no index, or no interval."""
    x = time(found["time"].values)
    for at, name in enumerate(parameters(found)):
        one = found.isel(parameter=at)
        margin = one[f"{order}_interval"].values
        y = np.where(np.isfinite(margin), one[order].values, np.nan)
        look = style.distinct(at) | {"marker": "", "linewidth": 0.9}
        if np.isfinite(y).any():
            ax.plot(x, y, label=labels.parameter(name), **look)
            band = {"color": look["color"], "alpha": 0.15, "linewidth": 0}
            ax.fill_between(x, y - margin, y + margin, **band)
    if not ax.lines:
        style.remark(ax, "no finite values")
    low, high = ax.get_ylim()
    ax.set_ylim(max(min(low, 0.0), _ENDS[0]), min(max(high, 1.0), _ENDS[1]))
    ax.set_ylabel("Share (–)")
    scales.linear(ax, "xy")
    verdict = access.read(found[VERDICT])
    if not verdict.sound:
        ax.set_title(ax.get_title(loc="left"), loc="left", pad=12)
        place = (0.0, 1.0)
        style.note(ax, verdict.words, place, (0, 3), warning=True, xycoords="axes fraction")


def _mean(ax: Axes, found: xr.Dataset, time: Display) -> None:
    """Draw the mean of the runs with a band of one standard deviation to either side."""
    mean, deviation = found["history_mean"], found["history_deviation"].values
    unit = display(mean.assign_attrs(units=str(found["history_units"].item())))
    x, y = time(found["time"].values), unit(mean.values)
    if np.isfinite(y).any():
        ax.plot(x, y, color="0.15", linewidth=0.9, label="_mean")
        ends = y - unit(deviation), y + unit(deviation)
        ax.fill_between(x, *ends, color="0.15", alpha=0.15, linewidth=0)
    else:
        style.remark(ax, "no finite values")
    ax.set_ylabel(labels.axis("mean", unit.symbol))
    scales.linear(ax, "xy")
