"""Figures of sensitivity indices: bars, convergence, pairs, elementary effects, indices over time.

Morris (1991), Technometrics 33, 161; µ* after Campolongo et al. (2007), Environ. Modell. Softw. 22.
"""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from impactlab.figures import access, labels, measures, record, scales, style
from impactlab.figures.data import name_places
from impactlab.figures.labels import Display, display
from impactlab.figures.measures import MORRIS, analysed, meanings
from impactlab.figures.record import Figure
from impactlab.methods import verdict_name
from impactlab.methods.record import Family, Measure
from impactlab.types import Floats
from impactlab.variables import status_bits

_THICK = 0.76  # thickness of all bars of a row together, in rows
_PALE = 0.45  # opacity of bars that are within the noise or below the numerical error
_SAMPLES = "base_samples"
_ENDS = (-0.25, 1.25)
"""Largest limits of the axis; intervals from few samples can be many times wider."""
_PAIRS = "second_order"
_CELLS = "Blues"
_WEAK = 0.1  # smallest upper end of the colour scale


def _missing(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return access.missing_note(runs, analysed(runs, analysis))


def index_bars(family: Family) -> Figure:
    """Return the figure of one family of measures."""

    @record.figure(
        family.title,
        family.meaning,
        lambda runs, analysis: family.given(analysis) and bool(analysed(runs, analysis)),
        lambda runs, analysis: (*_bar_sentences(family, analysis), _missing(runs, analysis)),
        family.figure,
    )
    def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
        """Draw a panel per response, a row per parameter (largest first), a bar per measure."""
        shown = family.measures_in(analysis)
        ranked = abs(analysis[family.ranked_by(analysis).name])
        largest = ranked.max([dim for dim in ranked.dims if dim != "parameter"]).fillna(-1.0)
        analysis = analysis.isel(parameter=np.argsort(-largest.values, kind="stable"))
        height = 10 + max(5.2, 2.4 * len(shown)) * analysis.sizes["parameter"]
        figure, axes = style.response_panels(analysed(runs, analysis), height, beneath=8)
        for response, ax in axes.items():
            bars(ax, analysis, family, response)
            ax.tick_params(axis="y", labelleft=style.starts_row(ax))
        return style.finish(figure, family.axis)

    return plot


def _bar_sentences(family: Family, analysis: xr.Dataset) -> list[str]:
    """Return a caption's sentences on what the bars, their lines and their shades are."""
    sources = {
        measure.label: analysis[measure.name].attrs.get("estimator")
        for measure in family.measures_in(analysis)
    }
    estimators = [f"{label}: {source}" for label, source in sources.items() if source]
    noise = "Pale: the interval holds zero."
    if any(f"dummy_{measure.name}" in analysis for measure in family.measures):
        noise = (
            "Dashed: upper end of the interval of a dummy parameter, which does nothing; what does "
            "not reach beyond it with its whole interval is noise, and pale."
        )
    numerical = any(f"{measure.name}_numerical" in analysis for measure in family.measures)
    return [
        f"Estimators: {'; '.join(estimators)}." if estimators else "",
        "Parameters are sorted by the largest index in any panel.",
        f"Lines on the bars: {access.confidence(analysis)} intervals"
        f"{', cut off outside −0.25 to 1.25' if family.shares else ''}.",
        noise,
        "Pale, too: below what the numerical error could change." if numerical else "",
    ]


def bars(ax: Axes, analysis: xr.Dataset, family: Family, response: str) -> None:
    """Draw a row per parameter and a bar per measure, pale within the noise, and the verdict.

    Pairs of measures are dark and light; the verdict is drawn where it is a warning.
    """
    shown, listed = family.measures_in(analysis), meanings(analysis)
    judged = verdict_name(analysis, lambda record: record.family == family)
    rows, count = np.arange(len(listed)), len(shown)
    colours = style.COLOURS if count < 4 else ("#0072B2", "#56B4E9", "#D55E00", "#E69F00")
    for number, (measure, colour) in enumerate(zip(shown, colours[:count], strict=True)):
        index = measures.index(analysis, measure.name, response)
        finite = np.isfinite(index.margins)
        margins = np.where(finite, index.margins, 0.0) if finite.any() else None
        places, thick = rows + _THICK * ((number + 0.5) / count - 0.5), _THICK / count
        look: Any = {"error_kw": {"elinewidth": 0.8, "ecolor": "0.15"}, "color": colour}
        container = ax.barh(places, index.values, thick, xerr=margins, label=measure.label, **look)
        for bar, stands in zip(container.patches, index.significant | ~finite, strict=True):
            bar.set_alpha(None if stands else _PALE)
        if index.floor:
            ends = [index.floor] if family.shares else [-index.floor, index.floor]
            dashes = (0, (3, 1.5))
            ax.vlines(ends, len(rows) - 0.5, -0.5, color=colour, linestyle=dashes, linewidth=0.9)
    ax.axvline(0.0, color="0.15", linewidth=0.6)
    verdict = access.verdict(analysis, judged, response)
    if np.isfinite(analysis[shown[0].name].sel(response=response)).any():
        style.warn(ax, verdict)
    else:
        style.remark(ax, f"undefined:\n{verdict.words if verdict else 'no reason is given'}")
    name_places(ax, "y", listed)
    ax.tick_params(axis="y", length=0)
    ax.grid(visible=False, axis="y")
    ax.set_ylim(len(rows) - 0.5, -0.5)
    low, high = ax.get_xlim()
    if family.shares:
        ax.set_xlim(max(min(low, 0.0), _ENDS[0]), min(max(high, 1.0), _ENDS[1]))
    else:
        ax.set_xlim(min(low, 0.0), max(high, 0.0))
    scales.linear(ax, "x")


def index_convergence(measure: Measure) -> Figure:
    """Return the figure of one measure against the number of samples, from their nested parts.

    It needs `<name>_by_samples` on (response, base_samples, parameter), and no new runs.
    """
    variable = f"{measure.name}_by_samples"

    def sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str]:
        opening = (
            f"The {measure.label} index from the first samples alone, up to all "
            f"{int(analysis[_SAMPLES].max())} base samples; bands: {access.confidence(analysis)} "
            "intervals, cut off outside −0.25 to 1.25. Indices that still drift beyond their bands "
            "at the right need more samples."
        )
        return opening, _missing(runs, analysis)

    title = f"{labels.sentence(measure.label)} indices against the number of samples"

    @record.figure(
        title,
        "",
        lambda runs, analysis: (
            bool(analysed(runs, analysis, variable)) and analysis.sizes[_SAMPLES] > 1
        ),
        sentences,
        f"{measure.name}_convergence",
    )
    def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
        """Draw a panel per response, a line with its band per parameter."""
        figure, axes = style.response_panels(analysed(runs, analysis), height=44)
        samples = analysis[_SAMPLES].values
        for name, ax in axes.items():
            indices = analysis.sel(response=name)
            for number, parameter in enumerate(meanings(analysis)):
                index = indices[[variable, f"{variable}_interval"]].isel(parameter=number)
                y, margin = (array.values for array in index.values())
                look = style.distinct(number) | {"label": parameter}
                _line_with_band(ax, samples, y, margin, markersize=2.5, **look)
            if not ax.lines:
                style.remark(ax)
            ax.set_xscale("log", base=2)
            scales.at(ax, "x", samples[::-2])
            low, high = ax.get_ylim()
            ax.set_ylim(max(low, _ENDS[0]), min(high, _ENDS[1]))
            scales.linear(ax, "y")
            style.warn(ax, access.verdict(analysis, access.VERDICT, name))
        return style.finish(figure, "Base samples (–)", "Share of the variance (–)")

    return plot


def _line_with_band(ax: Axes, x: Floats, y: Floats, margin: Floats, **look: Any) -> None:
    """Draw a line that has finite points, and a band of this margin to either side."""
    if np.isfinite(y).any():
        ax.plot(x, y, **look)
        ax.fill_between(x, y - margin, y + margin, color=look["color"], alpha=0.15, linewidth=0)


def _pair_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
    left = len(analysed(runs, analysis)) - len(_significant_pairs(runs, analysis))
    insignificant = f"{labels.counted(left, 'response')} without an index that differs from zero"
    return (
        f"Grey, without a number: zero lies within the {access.confidence(analysis)} interval.",
        f"Left out: {insignificant}." if left else "",
        _missing(runs, analysis),
    )


@record.figure(
    "Sobol indices of second order",
    "Share of the variance that two parameters bring together, those of the row and the column.",
    lambda runs, analysis: bool(_significant_pairs(runs, analysis)),
    _pair_sentences,
)
def sobol_second_order(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per response, a cell per pair, all on one colour scale."""
    significant, listed = _significant_pairs(runs, analysis), meanings(analysis)
    figure, axes = style.response_panels(list(significant), 7 + 4.6 * len(listed), beneath=14)
    values = {name: pairs(analysis[_PAIRS].sel(response=name)) for name in significant}
    # no weaker than _WEAK, to keep noise pale
    tops = [np.max(values[n], initial=_WEAK, where=where) for n, where in significant.items()]
    colours = Normalize(0.0, max(map(float, tops)))
    for name, ax in axes.items():
        _map(ax, values[name][:-1, 1:], significant[name][:-1, 1:], colours)
        style.warn(ax, access.verdict(analysis, access.VERDICT, name))
        _name_pairs(ax, listed)
    thin = 20 * min(len(axes), 2)
    scale = ScalarMappable(colours, _CELLS)
    bar = figure.colorbar(
        scale, ax=figure.axes, location="bottom", fraction=0.05, aspect=thin, shrink=0.6
    )
    narrow = len(figure.axes) == 2  # one panel, and the bar
    bar.set_label("Share of the variance (–)", loc="right" if narrow else "center")
    return figure


def _significant_pairs(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, NDArray[np.bool_]]:
    """Return the responses with an index of second order beyond its interval, and which are so."""
    interval = f"{_PAIRS}_interval"
    masks = {
        name: abs(pairs(analysis[_PAIRS].sel(response=name)))
        > pairs(analysis[interval].sel(response=name))
        for name in analysed(runs, analysis, _PAIRS, interval)
    }
    return {name: where for name, where in masks.items() if where.any()}


def pairs(index: xr.DataArray) -> Floats:
    """Return each pair once, above the diagonal; NaN elsewhere.

    index: on (parameter, other_parameter).
    """
    square = index.transpose("parameter", "other_parameter").values
    symmetric = np.where(np.isfinite(square), square, square.T)
    return np.where(np.triu(np.ones_like(symmetric, dtype=bool), 1), symmetric, np.nan)


def _map(ax: Axes, values: Floats, significant: NDArray[np.bool_], colours: Normalize) -> None:
    """Draw the cells, with two decimals of their values, as a cell has no room for more."""
    shown = np.where(significant, values, np.nan)
    ax.imshow(np.where(np.isfinite(values), 0.93, np.nan), cmap="gray", vmin=0, vmax=1)
    ax.imshow(shown, cmap=_CELLS, norm=colours, interpolation="nearest")
    for row, column in np.argwhere(np.isfinite(values) & significant):
        value = values[row, column]
        colour = "white" if colours(value) > 0.55 else "black"
        text = f"{value:z.2f}".replace("-", "−")
        if len(values) > _ROOMY:
            text = text.replace("0.", ".")
        ax.text(column, row, text, ha="center", va="center", fontsize=6, color=colour)


_ROOMY = 5  # largest number of columns that leave room for a zero before the point
_SHORT = 4  # letters of names that have room under a column


def _name_pairs(ax: Axes, listed: list[str]) -> None:
    """Name rows and columns, or number long names; the label names the last, which has no row."""
    rows, columns = listed[:-1], listed[1:]
    if max(map(len, listed)) > _SHORT:
        rows = [f"{name} ({number})" for number, name in enumerate(rows, 1)]
        columns = [str(number) for number in range(2, len(listed) + 1)]
        ax.set_xlabel(labels.wrapped_axis(listed[-1], str(len(listed))), loc="right")
    count = len(rows)
    ax.set_yticks(range(count), rows)
    ax.set_xticks(range(count), columns)
    ax.tick_params(labelleft=style.starts_row(ax))
    ax.set(xlim=(-0.5, count - 0.5), ylim=(count - 0.5, -0.5), aspect="auto")
    ax.tick_params(length=0)
    ax.grid(visible=False)
    for spine in ax.spines.values():
        spine.set_visible(False)


@record.figure(
    MORRIS.title,
    f"{MORRIS.meaning} Above σ = µ* an effect changes its size or sign with the others or "
    "along the range; below σ = 0.1 µ* it is nearly linear and additive.",
    lambda runs, analysis: bool(analysed(runs, analysis, "morris_mu_star", "morris_sigma")),
    lambda runs, analysis: (
        f"Lines: {access.confidence(analysis)} intervals of µ*.",
        _missing(runs, analysis),
    ),
)
def morris_plane(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a panel per response, a marker per parameter."""
    figure, axes = style.response_panels(analysed(runs, analysis), height=48)
    for name, ax in axes.items():
        plane(ax, runs, analysis, name)
    return style.finish(figure)


def plane(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, response: str) -> None:
    """Draw the elementary effects of a response, a marker per parameter."""
    strength = measures.index(analysis, "morris_mu_star", response)
    spread = analysis["morris_sigma"].sel(response=response).values
    effects = xr.DataArray(strength.values, attrs=runs[response].attrs, name=response)
    unit = display(effects)
    x, y, margin = unit(strength.values), unit(spread), unit(strength.margins)
    for number, parameter in enumerate(meanings(analysis)):
        if np.isfinite(y[number]):  # a group has no spread of its own
            xerr = margin[number] if np.isfinite(margin[number]) else None
            look = style.distinct(number) | {"linestyle": "", "elinewidth": 0.8}
            ax.errorbar(x[number], y[number], xerr=xerr, label=parameter, **look)
    style.warn(ax, access.verdict(analysis, access.VERDICT, response))
    if not ax.lines:
        style.empty(ax)
        return
    ax.set(xlabel=labels.axis("mean µ*", unit.symbol), ylabel=labels.axis("spread σ", unit.symbol))
    right, top = float(np.nanmax(x + np.nan_to_num(margin, posinf=0.0))), np.nanmax(y)
    ax.set(xlim=(0.0, 1.1 * right or 1.0), ylim=(0.0, 1.15 * max(top, 0.12 * right) or 1.0))
    for slope, text in ((1.0, "σ = µ*"), (0.1, "σ = 0.1 µ*")):
        ax.axline((0.0, 0.0), slope=slope, label="_guide", **style.GUIDE)
        end = min(0.97 * ax.get_xlim()[1], 0.9 * ax.get_ylim()[1] / slope)
        ax.text(end, slope * end, text, fontsize=6, color=style.MUTED, ha="right", va="bottom")
    scales.linear(ax, "xy")


def _time_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
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
    lambda runs, analysis: bool(measures.histories(analysis)),
    _time_sentences,
)
def indices_over_time(runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    """Draw a column per history: first order, total order and mean, one beneath the other."""
    names = measures.histories(analysis)
    histories = [labels.title(name) for name in names]
    titles = [
        f"{history}, {order}" for order in measures.OVER_TIME.values() for history in histories
    ]
    titles += [f"{history}, mean" for history in histories]
    figure, axes = style.titled_panels(titles, columns=len(names), height=38, sharex=True)
    time = display(analysis["time"])
    for row, order in enumerate(measures.OVER_TIME):
        for column, name in enumerate(names):
            _at_times(axes[row * len(names) + column], analysis.sel(history=name), order, time)
    for ax, name in zip(axes[-len(names) :], names, strict=True):
        _mean(ax, analysis.sel(history=name), time)
    return style.finish(figure, labels.axis("time since first touch", time.symbol))


def _at_times(ax: Axes, history: xr.Dataset, order: str, time: Display) -> None:
    """Draw a line with its band per parameter; gaps where there is no index, or no interval."""
    x = time(history["time"].values)
    for number, parameter in enumerate(meanings(history)):
        indices = history.isel(parameter=number)
        margin = indices[f"{order}_interval"].values
        y = np.where(np.isfinite(margin), indices[order].values, np.nan)
        look = style.distinct(number) | {"marker": "", "linewidth": 0.9}
        _line_with_band(ax, x, y, margin, label=parameter, **look)
    if not ax.lines:
        style.remark(ax)
    low, high = ax.get_ylim()
    ax.set_ylim(max(min(low, 0.0), _ENDS[0]), min(max(high, 1.0), _ENDS[1]))
    ax.set_ylabel("Share (–)")
    scales.linear(ax, "xy")
    style.warn(ax, access.read(history[measures.HISTORY_VERDICT]))


def _mean(ax: Axes, history: xr.Dataset, time: Display) -> None:
    """Draw the mean of the runs with a band of one standard deviation to either side."""
    mean, deviation = history["history_mean"], history["history_deviation"].values
    unit = display(mean.assign_attrs(units=str(history["history_units"].item())))
    x, look = time(history["time"].values), {"color": "0.15", "linewidth": 0.9}
    _line_with_band(ax, x, unit(mean.values), unit(deviation), label="_data: mean", **look)
    if not ax.lines:
        style.remark(ax)
    ax.set_ylabel(labels.axis("mean", unit.symbol))
    scales.linear(ax, "xy")
