"""Figures of questions to a study: the likeliest way, designs, and pairs of two models."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import labels, record, style

_MOST_PANELS = 6


@record.figure(
    "The likeliest way beyond the limit",
    "Each number of the likeliest run beyond the limit, with its value, in standard deviations "
    "from its median.",
    lambda result, _: "design_point" in result and bool(result["design_point"].notnull().all()),
    lambda *_: (),
)
def likeliest_way(result: xr.Dataset, _: xr.Dataset) -> Figure:
    """Draw how far each number is from its median in the likeliest run beyond the limit."""
    result = result.sel(parameter=~result["parameter"].isin(result.attrs["words"]))
    order = np.argsort(np.abs(result["design_point"].values), kind="stable")
    names = result["parameter_long_name"].values[order]
    figure, (ax,) = style.panels(1, columns=1, height=22 + 7 * order.size)
    rows, scores = np.arange(order.size), result["design_point"].values[order]
    ax.barh(rows, scores, color=style.COLOURS[0], height=0.6)
    ax.axvline(0.0, color="0.4", linewidth=0.8)
    texts = zip(names, result["design_value"].values[order], strict=True)
    ax.set_yticks(rows, [f"{labels.sentence(str(name))}\n{value}" for name, value in texts])
    ax.set_xlabel("standard deviations from the median (–)")
    return style.finish(figure)


@record.figure(
    "Designs over the probability",
    "Line: the best objective for a probability, with its interval; dots: designs whose "
    "probability was confirmed by runs; diamond: the design chosen.",
    lambda result, _: "tried_probability" in result,
    lambda *_: (),
)
def front(result: xr.Dataset, _: xr.Dataset) -> Figure:
    """Draw the front with its interval, and each design tried with that of its probability."""
    figure, (ax,) = style.panels(1, columns=1, height=62)
    unit = labels.display(result["tried_objective"])
    tried = result.isel(estimate=np.isfinite(result["tried_probability"].values))
    middle = tried["tried_probability"].values
    ends = [middle - tried["tried_low"].values, tried["tried_high"].values - middle]
    objectives = unit(result["front_objective"].transpose("bound", "front").values)
    if objectives.size:
        x = result["front"].values
        best: Any = {"color": style.COLOURS[0], "linewidth": 0}
        ax.fill_between(x, objectives[1], objectives[2], alpha=0.25, label="its interval", **best)
        ax.plot(x, objectives[0], color=style.COLOURS[0], label="best for a probability")
    ax.errorbar(
        middle, unit(tried["tried_objective"].values), xerr=ends, fmt="o", markersize=3.5,
        color="0.25", capsize=2, label="confirmed by runs",
    )  # fmt: skip
    chosen: Any = {"marker": "D", "linestyle": "none", "color": style.COLOURS[1], "markersize": 5}
    value = unit(result["objective"].values[0])
    ax.plot(result["probability"].values[:1], [value], label="chosen", **chosen)
    ax.axvline(
        float(result.attrs["largest_probability"]),
        color="0.4",
        linestyle=":",
        label="wanted at most",
    )
    ax.set_xscale("log")
    ax.set_xlabel(labels.wrapped_axis(str(result["tried_probability"].attrs["long_name"]), ""))
    ax.set_ylabel(labels.axis(str(result["objective"].attrs["long_name"]), unit.symbol))
    style.legend(figure)
    return style.finish(figure)


@record.figure(
    "Both models, run by run",
    "Each dot is a run of both models; the line through them corrects the fast one, and the dotted "
    "line is where both agree.",
    lambda result, _: "slow" in result and bool((result["fast"] + result["slow"]).notnull().any()),
    lambda *_: (),
)
def pairs(result: xr.Dataset, _: xr.Dataset) -> Figure:
    """Draw the slow model's outputs over those of the fast one, with the line through them."""
    complete = (result["fast"] + result["slow"]).notnull().values
    rows = np.flatnonzero(complete.any(axis=1))[:_MOST_PANELS]
    figure, axes = style.panels(rows.size, columns=min(rows.size, 2), height=62)
    for ax, row in zip(axes, rows, strict=True):
        alone = result.isel(response=row, pair=np.flatnonzero(complete[row]))
        attrs = {"units": str(alone["response_units"].item())}
        unit = labels.display(alone["slow"].assign_attrs(attrs))
        fast, slow = unit(alone["fast"].values), unit(alone["slow"].values)
        ends = np.array([fast.min(), fast.max()])
        ax.plot(ends, ends, color="0.4", linestyle=":", linewidth=0.8, label="both agree")
        if np.ptp(fast):
            ax.plot(ends, np.polyval(np.polyfit(fast, slow, 1), ends), color=style.COLOURS[1],
                    label="line through the runs")  # fmt: skip
        ax.plot(fast, slow, "o", color=style.COLOURS[0], markersize=3, label="runs of both")
        text = labels.response(str(alone["response"].item()))
        ax.set_xlabel(labels.wrapped_axis(f"{text}, fast model", unit.symbol))
        ax.set_ylabel(labels.wrapped_axis(f"{text}, slow model", unit.symbol))
    style.legend(figure)
    return style.finish(figure)


FIGURES = likeliest_way, front, pairs
