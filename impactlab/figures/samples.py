"""Figures of a sample: distributions, scatter plots and tests of the surrogates."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from numpy.typing import NDArray

from impactlab.figures import access, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, known, responses, usable, varied
from impactlab.figures.curves import spread
from impactlab.figures.labels import display
from impactlab.figures.record import Figure

Array = NDArray[np.float64]
_HISTOGRAM_BINS = (10, 40)
"""The fewest and the most bins; between them, the square root of the number of runs."""
_FEW = 10
"""Number of distinct values up to which each has a bar."""
_MOSTLY = 0.5
"""Share of the runs from which on a common value is left out, as it would hide the rest."""
_WARNING = style.COLOURS[1]
_SHOWN = 2000
"""Largest number of runs drawn as points; the mean is over all runs."""
_POINTS: dict[str, Any] = {
    "linestyle": "",
    "marker": ".",
    "markersize": 1.6,
    "markeredgewidth": 0.0,
    "color": "0.6",
}
_BINS, _FEWEST = 20, 30
"""Largest number of bins of the mean, and smallest number of runs in a bin."""
_MOST = 400
"""Largest number of points in a panel of surrogates; more hide each other."""


def _distributions_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the runs are a sample."""
    return is_sample(runs) and bool(responses(runs))


def _distributions_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Histograms of the responses over the sample. Line: median; shaded: from the 5th to the "
        f"95th percentile.{_jumps(runs)} {access.missing_note(runs, responses(runs))}".strip()
    )


@style.paper
def _plot_distributions(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, of the runs that have it."""
    figure, axes = responses_grid.panels(responses(runs), height=40)
    for name, ax in axes.items():
        values, label = responses_grid.shown(runs, name)
        ax.set_title(label, loc="left")
        _distribution(ax, values.values[np.isfinite(values.values)])
    figure.supylabel("Number of runs (–)")
    return figure


def _distribution(ax: Axes, values: Array) -> None:
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


def _bars(ax: Axes, distinct: Array, counts: NDArray[np.int_]) -> None:
    """Draw a bar per value."""
    width = 0.5 * float(np.diff(distinct).min())
    ax.bar(distinct, counts, width=width, color=style.COLOURS[0], zorder=2)
    scales.at(ax, "x", distinct)


def _beside(ax: Axes, values: Array, common: float) -> None:
    """Draw the histogram of the rest, and state the share of the common value."""
    rest = values[values != common]
    ax.hist(rest, bins=_bins(rest), color=style.COLOURS[0], zorder=2)
    share = 100 * (1 - rest.size / values.size)
    text = f"{share:.0f} % of the runs: {labels.number(common)}\n(not drawn)"
    ax.margins(y=0.35)
    ax.text(0.98, 0.98, text, transform=ax.transAxes, ha="right", va="top", color=_WARNING)
    scales.linear(ax, "x")


def _histogram(ax: Axes, values: Array) -> None:
    low, middle, high = np.percentile(values, [5, 50, 95])
    ax.axvspan(low, high, color="0.93", zorder=0)
    ax.hist(values, bins=_bins(values), color=style.COLOURS[0], zorder=2)
    ax.axvline(middle, color=style.COLOURS[1], linewidth=1.0, zorder=3)
    scales.linear(ax, "x")


def _bins(values: Array) -> int:
    return int(np.clip(np.sqrt(values.size), *_HISTOGRAM_BINS))


def _jumps(runs: xr.Dataset) -> str:
    """Return a sentence on the responses that take few values, or mostly one."""
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


DISTRIBUTIONS = Figure(
    "response_distributions",
    "Distributions of the responses",
    _distributions_applies,
    _plot_distributions,
    _distributions_caption,
)


def scatters(runs: xr.Dataset) -> tuple[Figure, ...]:
    """Return one scatter plot per response of the runs."""
    return tuple(scatter(name) for name in responses(runs))


def scatter(response: str) -> Figure:
    """Return the figure of a response against each parameter."""
    return Figure(
        f"scatter_{response}",
        f"{labels.sentence(labels.response(response))} against each parameter",
        partial(_scatter_applies, response),
        partial(_plot_scatter, response),
        partial(_scatter_caption, response),
    )


def _scatter_applies(response: str, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the runs are a sample with this response."""
    return is_sample(runs) and response in runs and bool(varied(runs))


def _scatter_caption(response: str, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    total = runs.sizes["run"]
    points = f"{_SHOWN} of the {total} runs, drawn at random" if total > _SHOWN else "the runs"
    return (
        f"Points: {points}. Line: mean of the response over all runs with about this value of "
        "the parameter; where it is flat, the parameter alone changes nothing. "
        f"{access.missing_note(runs, [response])}".strip()
    )


@style.paper
def _plot_scatter(response: str, runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per parameter; points are a bitmap, which keeps the vector file small."""
    names = varied(runs)
    figure, axes = style.panels(len(names), columns=3, height=42, sharey=True)
    values, label = responses_grid.shown(runs, response)
    for ax, name in zip(axes, names, strict=True):
        unit = display(runs[name])
        _panel(ax, unit(runs[name].values), values.values)
        ax.set_xlabel(labels.wrapped_axis(labels.parameter(name), unit.symbol))
    if response in runs and not np.isfinite(values.values).any():
        for ax in axes:
            style.remark(ax, "no finite values")
    figure.supylabel(label)
    style.legend(figure)
    return figure


def conditional_mean(x: Array, y: Array) -> tuple[Array, Array]:
    """Return means of x and y in bins of x with about equal numbers of runs.

    x, y: (runs,), finite. Runs with the same x share a bin.
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


def _validation_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has tested surrogates of these runs' responses."""
    return "surrogate_held_out" in analysis and bool(_with_surrogates(runs, analysis))


def _validation_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    tests = analysis.sizes["held_out"]
    shown = f", {_MOST} of them shown" if tests > _MOST else ""
    return (
        "Prediction of a polynomial chaos against the solver's answer, for "
        f"{labels.counted(tests, 'run')} that it was not fitted to{shown}; on the line both agree. "
        "Q²: 1 less the mean squared error over the variance of all of them. "
        f"{access.missing_note(runs, _with_surrogates(runs, analysis))}".strip()
    )


@style.paper
def _plot_validation(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, in the same unit on both axes."""
    figure, axes = responses_grid.panels(_with_surrogates(runs, analysis), height=46)
    for name, ax in axes.items():
        _held_out(ax, runs, analysis, name)
        _worth(ax, analysis, name)
    figure.supxlabel("Computed by the solver")
    figure.supylabel("Predicted by the surrogate")
    return figure


def _with_surrogates(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    return [name for name in responses(runs) if known(analysis, name)]


def _held_out(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    answers = usable(runs, name).rename(name).assign_attrs(runs[name].attrs)
    unit = display(answers)
    ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
    found = analysis["surrogate_held_out"].sel(response=name)
    found = found[spread(found.size, min(found.size, _MOST))]
    computed = unit(answers.set_index(run="run").sel(run=found["held_out"].values))
    predicted = unit(found)
    given = np.isfinite(computed) & np.isfinite(predicted)
    if not given.any():
        return
    ends = np.array([computed[given], predicted[given]])
    low, high = float(ends.min()), float(ends.max())
    ax.axline((low, low), (high, high), label="_guide", **style.GUIDE)
    ax.plot(
        computed[given],
        predicted[given],
        linestyle="",
        marker="o",
        markersize=1.8,
        markeredgewidth=0,
        alpha=0.6,
        color=style.COLOURS[0],
        label="runs held out",
    )
    for which in ("x", "y"):
        scales.linear(ax, which, ticks=4)


def _worth(ax: Axes, analysis: xr.Dataset, name: str) -> None:
    """Write Q² in the corner that agreement leaves empty, with a warning where there is one."""
    verdict = access.verdict(analysis, "surrogate_verdict", name)
    if not ax.lines:
        responses_grid.empty(ax, f"no surrogate:\n{verdict.words if verdict else 'unknown'}")
        return
    q2 = float(analysis["surrogate_q2"].sel(response=name))
    sound = verdict is None or verdict.sound
    text = f"Q² = {labels.number(q2)}"
    ax.annotate(
        text if sound or verdict is None else f"{text}\n{verdict.words}",
        (0.04, 0.96),
        xycoords="axes fraction",
        va="top",
        fontsize=7,
        fontweight="normal" if sound else "bold",
        color=style.MUTED if sound else style.COLOURS[1],
    )


SURROGATE_VALIDATION = Figure(
    "surrogate_validation",
    "Surrogates against the solver",
    _validation_applies,
    _plot_validation,
    _validation_caption,
)
