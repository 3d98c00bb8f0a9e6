"""Figures of questions to a study: the likeliest way, designs, two models, a calibration."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.analysis.measurements import COVERAGE
from impactlab.analysis.posterior import SILENT
from impactlab.figures import labels, measures, record, scales, style
from impactlab.solver.contact import CONTACT_LAWS, LawRecord

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
    ax.set_xlabel("Standard deviations from the median (–)", loc="right")
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


_BINS = 25
_PRIOR = "0.75"


@style.paper
def calibration(results: xr.Dataset) -> Figure:
    """Draw a panel per parameter, one of all predictions, and one of the contact laws' weights."""
    meanings = measures.meanings(results)
    laws = results.sizes["model"] > 1
    figure, axes = style.panels(len(meanings) + 1 + laws, columns=3, height=50)
    for number, meaning in enumerate(meanings):
        _parameter(axes[number], results.isel(parameter=number), meaning)
    _predictions(axes[len(meanings)], results)
    if laws:
        order = np.argsort(results["model_weight"].values, kind="stable")
        rows = np.arange(order.size)
        axes[-1].barh(rows, results["model_weight"].values[order], color=style.COLOURS[0])
        listed = [
            CONTACT_LAWS.get(name, LawRecord(name=name, short=name)).short
            for name in results["model"].values[order]
        ]
        axes[-1].set_yticks(rows, listed)
        axes[-1].set(xlabel="weight (–)", xlim=(0.0, 1.0), ylabel="contact law")
    return style.finish(figure)


def _parameter(ax: Axes, marginal: xr.Dataset, meaning: str) -> None:
    """Draw the posterior's histogram over the density of the prior."""
    name, attrs = str(marginal["parameter"].item()), dict(marginal.attrs)
    attrs["units"] = str(marginal["parameter_units"].item())
    unit = labels.display(xr.DataArray(marginal["prior_draws"].values, name=name, attrs=attrs))
    prior, posterior = unit(marginal["prior_draws"].values), unit(marginal["draws"].values)
    bins: Any = np.linspace(prior.min(), prior.max(), _BINS + 1).tolist()
    ax.hist(prior, bins=bins, density=True, label="before the data", color=_PRIOR)
    look: Any = {"histtype": "step", "linewidth": 1.5, "color": style.COLOURS[0]}
    ax.hist(posterior, bins=bins, density=True, label="given the data", **look)
    ax.set(xlabel=labels.wrapped_axis(meaning, unit.symbol), yticks=[])
    ax.set_ylabel("probability density")
    scales.linear(ax, "x", 4)
    single = np.isfinite(marginal["mode_weight"]).sum() == 1
    if single and float(marginal["spread_ratio"]) >= SILENT:
        corner: Any = {"xycoords": "axes fraction"}
        style.note(ax, "the data cannot tell", (0.0, 1.0), (0, 3), warning=True, **corner)


def _predictions(ax: Axes, results: xr.Dataset) -> None:
    """Draw each measurement and its prediction, in standard uncertainties from the measurement."""
    scale = COVERAGE / results["measured_uncertainty"].values
    rows = np.arange(results.sizes["measurement"], dtype=float)
    off = (results["predicted_mean"].values - results["measured"].values) * scale
    parts = [results[key].values for key in ("predicted_deviation", "surrogate_error")]
    looks: Any = {"linestyle": "", "elinewidth": 1.0, "capsize": 2.0, "markersize": 3.0}
    for y, centre, bar, label, colour, marker in (
        (rows + 0.12, 0 * rows, results["measured_uncertainty"].values, "measured", "black", "D"),
        (rows - 0.12, off, COVERAGE * np.hypot(*parts), "predicted", style.COLOURS[1], "o"),
    ):
        looks |= {"label": label, "color": colour, "marker": marker}
        ax.errorbar(centre, y, xerr=bar * scale, **looks)
    ax.set_yticks(rows, measured_words(results), fontsize=6)
    ax.set_ylim(rows.size - 0.5, -0.5)
    ax.set(xlabel="from the measured value\n(standard uncertainties)", ylabel="measurement")


def measured_words(results: xr.Dataset) -> list[str]:
    """Return the measurements in words, with the conditions in which they differ."""
    stated = [json.loads(text) for text in results["measured_conditions"].values.tolist()]
    keys = dict.fromkeys(key for conditions in stated for key in conditions)
    differ = [key for key in keys if len({conditions.get(key) for conditions in stated}) > 1]
    texts = []
    for name, conditions in zip(results["measured_quantity"].values.tolist(), stated, strict=True):
        values = [
            f"{key.replace('_', ' ')} {conditions[key]}" for key in differ if key in conditions
        ]
        texts.append(", ".join([labels.response(name), *values]))
    return texts
