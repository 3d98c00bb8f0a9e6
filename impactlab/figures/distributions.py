"""Figures of distributions: histograms, cumulative curves with their band, parameters by limit."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from impactlab.analysis.distribution import cumulative, drawn_outputs, limits, significance
from impactlab.figures import access, labels, record, scales, style
from impactlab.figures.access import is_sample, responses, usable
from impactlab.figures.labels import display
from impactlab.figures.measures import analysed
from impactlab.figures.record import Figure
from impactlab.figures.samples import along_parameters, places, ticks
from impactlab.methods import SAMPLES, independent_runs
from impactlab.methods.runs import Sample
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF

_WARNING = style.COLOURS[1]
_FEW = 10  # number of distinct values up to which each has a bar
_MOSTLY = 0.5
"""Share of the runs from which on a common value is left out, as it would hide the rest."""
_MOST = 300  # largest number of steps drawn of a curve


@record.figure(
    "Distributions of the responses",
    "Histograms of the responses over all runs of the sample.",
    lambda runs, analysis: is_sample(runs) and bool(responses(runs)),
    lambda runs, analysis: (
        "Line: median; shaded: from the 5th to the 95th percentile of the independent draws."
        if "quantile" in analysis
        else "",
        *_jumps(runs),
        access.missing_note(runs, responses(runs)),
    ),
)
def response_distributions(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per response, of the runs that have it."""
    figure, axes = style.response_panels(responses(runs), height=40)
    for name, ax in axes.items():
        values, label = style.in_display_units(runs, name)
        ax.set_title(label, loc="left")
        percentiles = None
        if analysed(runs, analysis, "quantile") and access.known(analysis, name):
            quantiles = analysis["quantile"].sel(response=name, probability=[0.05, 0.5, 0.95])
            percentiles = display(usable(runs, name))(quantiles)
        _distribution(ax, values.values[np.isfinite(values.values)], percentiles)
    return style.finish(figure, y="Number of runs (–)")


def _distribution(ax: Axes, values: Floats, percentiles: Floats | None) -> None:
    if values.size == 0 or np.ptp(values) <= ROUND_OFF * np.abs(values).max():
        text = f"constant: {labels.number(float(values[0]))}" if values.size else "no finite values"
        style.empty(ax, text)
        return
    distinct, counts = np.unique(values, return_counts=True)
    if distinct.size <= _FEW:
        width = 0.5 * float(np.diff(distinct).min())
        ax.bar(distinct, counts, width=width, color=style.COLOURS[0], zorder=2)
        scales.at(ax, "x", distinct)
        scales.linear(ax, "y")
        return
    if counts.max() >= _MOSTLY * values.size:
        common, total = float(distinct[counts.argmax()]), values.size
        values = values[values != common]
        share = 100 * (1 - values.size / total)
        text = f"{share:.0f} % of the runs: {labels.number(common)}\n(not drawn)"
        ax.margins(y=0.35)
        ax.text(0.98, 0.98, text, transform=ax.transAxes, ha="right", va="top", color=_WARNING)
    elif percentiles is not None:
        low, middle, high = percentiles
        ax.axvspan(low, high, color="0.93", zorder=0)
        ax.axvline(middle, color=style.COLOURS[1], linewidth=1.0, zorder=3)
    bins = int(np.clip(np.sqrt(values.size), 10, 40))
    ax.hist(values, bins=bins, color=style.COLOURS[0], zorder=2)
    scales.linear(ax, "xy")


def _jumps(runs: xr.Dataset) -> list[str]:
    """Return sentences on the responses that take few values, or mostly one."""
    few, mostly = [], []
    for name in responses(runs):
        values = usable(runs, name).values
        distinct, counts = np.unique(values[np.isfinite(values)], return_counts=True)
        if 1 < distinct.size <= _FEW:
            few.append(labels.response(name))
        elif distinct.size > 1 and counts.max() >= _MOSTLY * counts.sum():
            mostly.append(labels.response(name))
    return [
        f"Bars, for there are few values: {labels.listing(few)}." if few else "",
        f"Mostly one value, drawn without it: {labels.listing(mostly)}." if mostly else "",
    ]


def spread_evenly(runs: xr.Dataset) -> str:
    """Return the clause on intervals of draws that are no random ones; "" for others."""
    method = SAMPLES.get(str(runs.attrs.get("method")))
    if method is None or not method.even:
        return ""
    return ", which is on the safe side, for the draws spread more evenly than random ones"


def limited(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return the responses with a limit that the analysis has."""
    return [name for name in analysed(runs, analysis, "limit") if name in limits(runs)]


def _cumulative_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
    band = f"Shaded: the {access.confidence(analysis)} band of Dvoretzky, Kiefer and Wolfowitz"
    return (
        f"{band}, which holds the whole curve{spread_evenly(runs)}.",
        "Dashed: the limit." if limited(runs, analysis) else "",
        access.missing_note(runs, analysed(runs, analysis)),
    )


@record.figure(
    "Cumulative distributions of the responses",
    "Share of the independent draws of the sample with a response up to each value.",
    lambda runs, analysis: bool(analysed(runs, analysis, "quantile")),
    _cumulative_sentences,
)
def cumulative_distributions(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per response: the curve, its band, and the limit if the study has one."""
    names, thresholds = analysed(runs, analysis), limits(runs)
    figure, axes = style.response_panels(names, height=40)
    level = float(analysis.attrs.get("confidence", 0.95))
    for name, ax in axes.items():
        unit = display(runs[name])
        ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
        values, share, low, high = cumulative(drawn_outputs(runs, name), level)
        if not values.size:
            style.empty(ax)
            continue
        steps = scales.spread(values.size, _MOST)
        x = unit(values[steps])
        ax.fill_between(x, low[steps], high[steps], step="post", color="0.87", label="band")
        ax.step(x, share[steps], where="post", color=style.COLOURS[0], label="share of the draws")
        if name in thresholds:
            limit = float(unit(thresholds[name]))
            ax.axvline(limit, label="_guide: limit", linestyle="--", **style.GUIDE)
        ax.set_ylim(0.0, 1.0)
        scales.linear(ax, "xy", 4)
    return style.finish(figure, y="Share of the draws (–)")


def exceedance(response: str) -> Figure:
    """Return the figure of each parameter in runs above the limit of a response, and in others."""

    def sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
        statistics = analysis.sel(response=response)
        above, total, missing = (int(np.nan_to_num(statistics[key])) for key in _COUNTS)
        below = total - missing - above
        limit = labels.amount(runs[response], limits(runs)[response])
        return (
            "Cumulative distribution of each parameter, of words the share of each, in the "
            f"{above:,} draws with a {labels.response(response)} above {limit}, and in the other "
            f"{below:,}.",
            "D: largest distance of the two (Kolmogorov and Smirnov); p: probability of such a "
            "distance if the parameter does not matter. Pale: not significant at the level of the "
            "intervals, shared among the parameters (Bonferroni).",
            access.missing_note(runs, [response]),
        )

    @record.figure(
        f"Parameters in runs above the limit of the {labels.response(response)}",
        "",
        lambda runs, analysis: (
            response in limited(runs, analysis)
            and bool(analysis["exceedance_distance"].sel(response=response).notnull().any())
        ),
        sentences,
        f"exceedance_{response}",
    )
    def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
        """Draw a panel per parameter."""
        sample = Sample.of(runs)
        outputs, rows = drawn_outputs(runs, response), independent_runs(sample)
        statistics, least = analysis.sel(response=response), significance(analysis)

        def draw(ax: Axes, column: xr.DataArray) -> None:
            test = statistics.sel(varied_parameter=str(column.name))
            distance, p = (float(test[f"exceedance_{key}"]) for key in ("distance", "p_value"))
            _two_curves(ax, column[rows], outputs, limits(runs)[response], p < least)
            if np.isfinite(distance):
                small = "p < 0.001" if p < 0.001 else f"p = {labels.number(p, 2)}"
                text, place = f"D = {distance:.2f}\n{small}", (0.04, 0.96)
                corner = {"xycoords": "axes fraction", "va": "top"}
                style.note(ax, text, place, (0, 0), warning=False, **corner)

        return along_parameters(sample.runs, "Share of the draws (–)", 40, draw)

    return plot


_COUNTS = ("exceeding_draws", "number_of_draws", "missing_draws")


def _two_curves(
    ax: Axes, column: xr.DataArray, outputs: Floats, limit: float, matters: bool
) -> None:
    """Draw the cumulative distributions of a parameter (draws,) above the limit and below it."""
    x, above, below = places(column), outputs > limit, outputs <= limit
    if not above.any() or not below.any():
        style.empty(ax, "all draws on one side" if (above | below).any() else "no answer")
        return
    kinds = {"above the limit": (above, style.COLOURS[1]), "others": (below, style.COLOURS[0])}
    for label, (which, colour) in kinds.items():
        if labels.words(column):  # whose order has no meaning
            values, counts = np.unique(x[which], return_counts=True)
            (line,) = ax.plot(values, counts / which.sum(), "D", color=colour, label=label)
        else:
            ordered = np.sort(x[which])
            steps = np.array(scales.spread(ordered.size, _MOST))
            share = (steps + 1) / ordered.size
            (line,) = ax.step(ordered[steps], share, where="post", color=colour, label=label)
        line.set_alpha(None if matters else 0.4)
    ax.set_ylim(0.0, 1.0)
    ticks(ax, "x", column)
    scales.linear(ax, "y", 4)
