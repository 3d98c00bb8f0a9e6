"""The figure of a calibration: posterior beside prior, predictions beside data, weights of laws."""

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.analysis.measurements import COVERAGE
from impactlab.analysis.posterior import SILENT
from impactlab.figures import labels, measures, scales, style
from impactlab.solver.contact import CONTACT_LAWS, LawRecord

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
