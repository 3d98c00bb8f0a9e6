"""Figures of a sample: scatter plots, tests of surrogates, and where runs fail."""

from collections.abc import Callable
from itertools import combinations
from typing import Any, Literal

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from impactlab.analysis.distribution import filtered
from impactlab.analysis.regimes import of_runs
from impactlab.figures import access, labels, record, scales, style
from impactlab.figures.access import is_sample, usable, varied
from impactlab.figures.data import name_places
from impactlab.figures.labels import display
from impactlab.figures.measures import analysed
from impactlab.figures.record import Figure
from impactlab.types import Floats

_WARNING = style.COLOURS[1]
_SHOWN = 2000  # largest number of runs drawn as points; the mean is over all runs
_POINTS: dict[str, Any] = {
    "linestyle": "",
    "marker": ".",
    "markersize": 1.6,
    "markeredgewidth": 0.0,
    "color": "0.6",
}
_NAMES = 14.0  # height of the names of words under a panel, mm
_BINS, _FEWEST = 20, 30  # largest number of bins of the mean, and smallest number of runs in a bin
_PERFECT = 0.9999  # Q² beyond which rounding would say 1
_MOST = 400  # largest number of points in a panel of surrogates; more hide each other
_DRAWN = {"good": 2000, "failed": 1000}  # largest numbers of runs in the map
_LOOKS: dict[str, dict[str, Any]] = {
    "good": {"color": "0.65", "marker": ".", "markersize": 2.0, "markeredgewidth": 0.0},
    "failed": {"color": _WARNING, "marker": "x", "markersize": 3.0, "markeredgewidth": 0.8},
}


def scatter(response: str) -> Figure:
    """Return the figure of a response against each parameter."""

    def sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str]:
        total = runs.sizes["run"]
        columns = [runs[name] for name in varied(runs)]
        points = f"{_SHOWN} of the {total} runs, drawn at random" if total > _SHOWN else "the runs"
        opening = (
            f"Points: {points}. Line: mean of the response over all runs with about this value of "
            "the parameter; where it is flat, the parameter alone changes nothing."
        )
        if of_runs(runs, response).size:
            opening += " Each regime has a line of its own."
        if any(map(labels.words, columns)):
            opening += " Diamonds: mean over all runs with this word."
        return opening, access.missing_note(runs, [response])

    title = f"{labels.title(response)} against each parameter"

    @record.figure(
        title,
        "",
        lambda runs, analysis: is_sample(runs) and response in runs and bool(varied(runs)),
        sentences,
        f"scatter_{response}",
    )
    def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
        """Draw a panel per parameter; points are a bitmap, which keeps the vector file small."""
        values, label = style.in_display_units(runs, response)
        middles = display(runs[response])(of_runs(runs, response))
        return along_parameters(
            runs, label, 42, lambda ax, column: scatter_runs(ax, column, values.values, middles)
        )

    return plot


def along_parameters(
    runs: xr.Dataset, label: str, height: float, draw: Callable[[Axes, xr.DataArray], None]
) -> Drawing:
    """Draw a panel per parameter, given as its column of the runs."""
    names = varied(runs)
    if any(labels.words(runs[name]) for name in names):
        height += _NAMES
    figure, axes = style.panels(len(names), columns=3, height=height, sharey=True)
    for ax, name in zip(axes, names, strict=True):
        draw(ax, runs[name])
        ax.set_xlabel(axis_label(runs[name]))
    return style.finish(figure, y=label)


def axis_label(column: xr.DataArray) -> str:
    """Return the label of the axis of a parameter, with a unit where it takes numbers."""
    text, symbol = labels.parameter(column), display(column).symbol
    return labels.sentence(text) if labels.words(column) else labels.wrapped_axis(text, symbol)


def places(column: xr.DataArray) -> Floats:
    """Return a parameter in its display unit, (runs,), or the places of its words (else NaN)."""
    if not labels.words(column):
        return display(column)(column.values)
    listed = np.atleast_1d(column.attrs["values"])
    matches = column.values[:, None] == listed
    return np.where(matches.any(axis=1), matches.argmax(axis=1).astype(float), np.nan)


def _beside(column: xr.DataArray, places: Floats) -> Floats:
    """Return places, those of words moved at random, so that points do not hide each other."""
    if not labels.words(column):
        return places
    return places + 0.6 * (np.random.default_rng(2).random(places.size) - 0.5)


def ticks(ax: Axes, which: Literal["x", "y"], column: xr.DataArray) -> None:
    """Make an axis one of numbers, or of the names of words."""
    if not (listed := labels.words(column)):
        scales.linear(ax, which, 4)
        return
    ax.set(**{f"{which}lim": (-0.5, len(listed) - 0.5)})
    name_places(ax, which, listed)
    ax.tick_params(axis=which, labelrotation=90.0 if which == "x" else 0.0)
    ax.grid(visible=False, axis=which)


def scatter_runs(ax: Axes, column: xr.DataArray, y: Floats, middles: Floats) -> None:
    """Draw some of the runs over a parameter, and the mean of all about each value, or word.

    column, y: (runs,), a varied coordinate and a response in its display unit. middles: of the gaps
    between its regimes, in that unit; each regime has its own mean.
    """
    ticks(ax, "x", column)
    x = places(column)
    finite = np.isfinite(x) & np.isfinite(y)
    if not np.isfinite(y).any():
        style.remark(ax)
    x, y = x[finite], y[finite]
    if not x.size:
        return
    chosen = np.random.default_rng(1).permutation(x.size)[:_SHOWN]  # a sample's order has structure
    ax.plot(_beside(column, x)[chosen], y[chosen], label="_runs", rasterized=True, **_POINTS)
    regime = np.searchsorted(middles, y)
    for part in (regime == number for number in np.unique(regime)):
        if labels.words(column):
            middle = np.unique(x[part])
            mean = np.array([y[part & (x == place)].mean() for place in middle])
            look: dict[str, Any] = {"linestyle": "", "marker": "D", "label": "mean by word"}
        else:
            middle, mean = conditional_mean(x[part], y[part])
            look = {"linewidth": 1.5, "label": "conditional mean"}
        ax.plot(middle, mean, color=style.COLOURS[1], **look)
    scales.linear(ax, "y", 4)


def conditional_mean(x: Floats, y: Floats) -> tuple[Floats, Floats]:
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


def _validation_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str]:
    tests = analysis.sizes["held_out"]
    shown = f", {_MOST} of them shown" if tests > _MOST else ""
    opening = (
        "Prediction of a polynomial chaos against the solver's answer, for "
        f"{labels.counted(tests, 'run')}, by fits that left them out{shown}; on the line both "
        "agree. Q²: 1 less the mean squared error over the variance of all of them."
    )
    return opening, access.missing_note(runs, analysed(runs, analysis))


@record.figure(
    "Surrogates against the solver",
    "",
    lambda runs, analysis: bool(analysed(runs, analysis, "surrogate_held_out")),
    _validation_sentences,
)
def surrogate_validation(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per response, in the same unit on both axes."""
    figure, axes = style.response_panels(analysed(runs, analysis), height=46)
    for name, ax in axes.items():
        _held_out(ax, runs, analysis, name)
        verdict = access.verdict(analysis, "surrogate_verdict", name)
        if not ax.lines:
            style.empty(ax, f"no surrogate:\n{verdict.words if verdict else 'unknown'}")
            continue
        q2 = float(analysis["surrogate_q2"].sel(response=name))
        text = "Q² > 0.9999" if q2 > _PERFECT else f"Q² = {labels.number(q2)}"
        warning = verdict is not None and not verdict.sound
        if verdict and warning:
            text += f"\n{verdict.words}"
        corner = {"xycoords": "axes fraction", "va": "top"}  # which agreement leaves empty
        style.note(ax, text, (0.04, 0.96), (0, 0), warning=warning, **corner)
    return style.finish(figure, "Computed by the solver", "Predicted by the surrogate")


def _held_out(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    answers = usable(runs, name)
    unit = display(answers)
    ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
    held_out = analysis["surrogate_held_out"].sel(response=name)
    held_out = held_out[scales.spread(held_out.size, _MOST)]
    computed = unit(answers.set_index(run="run").sel(run=held_out["held_out"].values))
    predicted = unit(held_out)
    finite = np.isfinite(computed) & np.isfinite(predicted)
    if not finite.any():
        return
    ends = np.array([computed[finite], predicted[finite]])
    low, high = float(ends.min()), float(ends.max())
    ax.axline((low, low), (high, high), label="_guide: agreement", **style.GUIDE)
    look: Any = {"linestyle": "", "marker": "o", "markersize": 1.8, "markeredgewidth": 0}
    look |= {"alpha": 0.6, "color": style.COLOURS[0]}
    ax.plot(computed[finite], predicted[finite], label="runs held out", **look)
    scales.linear(ax, "xy", ticks=4)


def _failure_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    failed = access.failed(runs)
    why = [f"{number} × “{text}”" for text, number in access.causes(runs, failed).items()]
    count = f"{int(failed.sum())} of {failed.size} runs failed, or are missing a response"
    return [f"{count}: {labels.listing(why)}."]


@record.figure(
    "Share of failed runs along each parameter",
    "Share of the runs that failed in each tenth of a parameter's draws, or with each word, with "
    "the 95 % interval of a binomial share (Wilson); dashed: the share of all runs. A parameter "
    "along which the share rises tells where runs fail.",
    lambda runs, analysis: (
        is_sample(runs) and bool(varied(runs)) and bool(access.failed(runs).any())
    ),
    _failure_sentences,
)
def failure_shares(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per parameter."""
    failed = access.failed(runs).values
    return along_parameters(
        runs, "Failed runs (%)", 36, lambda ax, column: _shares(ax, column, failed)
    )


def _shares(ax: Axes, column: xr.DataArray, failed: NDArray[np.bool_]) -> None:
    x = places(column)
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, 11)))
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(edges.size - 2, 0))
    if labels.words(column):
        place = x.astype(int)
    shares = []
    for number in np.unique(place):
        inside = place == number
        test = scipy.stats.binomtest(int(failed[inside].sum()), int(inside.sum()))
        low, high = test.proportion_ci(method="wilson")
        share = failed[inside].mean()
        shares.append((x[inside].mean(), 100 * share, 100 * (share - low), 100 * (high - share)))
    middle, share, below, above = np.array(shares).T
    look: Any = {"color": style.COLOURS[0], "marker": "o", "linestyle": "", "elinewidth": 0.8}
    ax.errorbar(middle, share, np.clip([below, above], 0.0, None), label="share", **look)
    ax.axhline(100 * failed.mean(), label="_guide: all runs", linestyle="--", **style.GUIDE)
    ax.set_ylim(0.0, None)
    ticks(ax, "x", column)
    scales.linear(ax, "y", 4)


def _distances(runs: xr.Dataset) -> dict[str, float]:
    """Return the Kolmogorov-Smirnov distances of the most telling parameters, the largest first."""
    failed = access.failed(runs).values.astype(float)
    columns = {name: runs[name].values for name in varied(runs)}
    apart = filtered(failed, 0.5, columns)["exceedance_distance"]
    distances = dict(zip(columns, apart, strict=True))
    ranked = sorted(distances, key=lambda name: -distances[name])
    return {name: distances[name] for name in ranked[:3]}


def _map_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    distances = _distances(runs).items()
    entries = [f"{labels.parameter(runs[name])} {value:.2f}" for name, value in distances]
    return [
        f"The {int(access.failed(runs).sum())} failed runs among the good ones (at most "
        f"{_DRAWN['failed']} and {_DRAWN['good']} are drawn), over the parameters whose values "
        "differ most between the two. Distance of Kolmogorov and Smirnov between failed and good "
        f"runs, 1 where they do not overlap: {labels.listing(entries)}."
    ]


@record.figure(
    "Where runs failed",
    "",
    lambda runs, analysis: (
        is_sample(runs)
        and len(varied(runs)) > 1
        and 0 < int(access.failed(runs).sum()) < runs.sizes["run"]
    ),
    _map_sentences,
)
def failure_map(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per pair of parameters."""
    pairs = list(combinations(_distances(runs), 2))
    figure, axes = style.panels(len(pairs), columns=max(len(pairs), 2), height=58)
    failed = access.failed(runs).values
    kinds = {"good": np.flatnonzero(~failed), "failed": np.flatnonzero(failed)}
    for ax, pair in zip(axes, pairs, strict=True):
        for kind, which in kinds.items():
            chosen = np.random.default_rng(1).permutation(which)[: _DRAWN[kind]]
            x, y = (_beside(runs[name], places(runs[name]))[chosen] for name in pair)
            ax.plot(x, y, linestyle="", label=kind, rasterized=kind == "good", **_LOOKS[kind])
        ax.set(xlabel=axis_label(runs[pair[0]]), ylabel=axis_label(runs[pair[1]]))
        ticks(ax, "x", runs[pair[0]])
        ticks(ax, "y", runs[pair[1]])
    return style.finish(figure)
