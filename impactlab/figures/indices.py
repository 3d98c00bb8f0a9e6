"""Figures of sensitivity indices: bars per family, and convergence with the sample."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from matplotlib.ticker import FixedFormatter

from impactlab.figures import access, labels, measures, responses_grid, scales, style
from impactlab.figures.measures import Family, Measure, analysed
from impactlab.figures.record import Figure

_THICK = 0.76
"""Thickness of all bars of a row together, in rows."""
_PALE = 0.45
"""Opacity of bars that are within the noise or below the numerical error."""
_SAMPLES = "base_samples"
_ENDS = (-0.25, 1.25)
"""Largest limits of the axis; intervals from few samples can be many times wider."""


def index_bars(name: str, family: Family) -> Figure:
    """Return the figure of one family of measures."""
    return Figure(
        name,
        family.title,
        partial(_bars_apply, family),
        partial(_plot_bars, family),
        partial(_bars_caption, family),
    )


def _bars_apply(family: Family, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has these indices, for responses of these runs."""
    return family.given(analysis) and bool(analysed(runs, analysis))


def _bars_caption(family: Family, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    sentences = (
        family.meaning,
        _estimator(analysis, family),
        f"Lines on the bars: {access.confidence(analysis)} intervals.",
        _floor_words(analysis, family),
        _numerical_words(analysis, family),
        access.missing_note(runs, analysed(runs, analysis)),
    )
    return " ".join(filter(None, sentences))


@style.paper
def _plot_bars(family: Family, runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a row per parameter, a bar per measure, pale within the noise."""
    rows, bars = analysis.sizes["parameter"], len(family.measures_in(analysis))
    height = 10 + max(4.2, 1.4 * bars) * rows
    figure, axes = responses_grid.panels(analysed(runs, analysis), height, beneath=8)
    for at, (name, ax) in enumerate(axes.items()):
        _bars(ax, analysis, family, name)
        undefined(ax, analysis, name, family.measures_in(analysis)[0].name)
        _rows(ax, measures.parameters(analysis), named=at % responses_grid.COLUMNS == 0)
        _reach(ax, shares=family.shares)
    figure.supxlabel(family.axis)
    style.legend(figure)
    return figure


def undefined(ax: Axes, analysis: xr.Dataset, response: str, measure: str) -> None:
    """Say in the panel why a response has no indices, or that they need care."""
    if bool(np.isfinite(analysis[measure].sel(response=response)).any()):
        responses_grid.warn(ax, analysis, "sensitivity_verdict", response)
        return
    found = access.verdict(analysis, "sensitivity_verdict", response)
    style.remark(ax, f"undefined:\n{found.words if found else 'no reason is given'}")


def _estimator(analysis: xr.Dataset, family: Family) -> str:
    found = analysis[family.measures_in(analysis)[0].name].attrs.get("estimator")
    return f"Estimator: {found}." if found else ""


def _floor_words(analysis: xr.Dataset, family: Family) -> str:
    if not any(f"dummy_{measure.name}" in analysis for measure in family.measures):
        return "Pale: the interval holds zero."
    return (
        "Dashed: upper end of the interval of a dummy parameter, which does nothing; what does not "
        "reach beyond it with its whole interval is noise, and pale."
    )


def _numerical_words(analysis: xr.Dataset, family: Family) -> str:
    given = any(f"{measure.name}_numerical" in analysis for measure in family.measures)
    return "Pale, too: below what the numerical error could change." if given else ""


def _bars(ax: Axes, analysis: xr.Dataset, family: Family, response: str) -> None:
    shown = family.measures_in(analysis)
    rows, count = np.arange(analysis.sizes["parameter"]), len(shown)
    for at, (measure, colour) in enumerate(zip(shown, _colours(count), strict=True)):
        found = measures.index(analysis, measure.name, response)
        finite = np.isfinite(found.margins)
        bars = ax.barh(
            rows + _THICK * ((at + 0.5) / count - 0.5),
            found.values,
            height=_THICK / count,
            color=colour,
            label=measure.words,
            xerr=np.where(finite, found.margins, 0.0) if finite.any() else None,
            error_kw={"elinewidth": 0.8, "ecolor": "0.15"},
        )
        for bar, stands in zip(bars.patches, found.significant | ~finite, strict=True):
            bar.set_alpha(None if stands else _PALE)
        if found.floor:
            ends = [found.floor] if family.shares else [-found.floor, found.floor]
            ax.vlines(ends, *_span(len(rows)), color=colour, linestyle=(0, (3, 1.5)), linewidth=0.9)
    ax.axvline(0.0, color="0.15", linewidth=0.6)


def _colours(count: int) -> tuple[str, ...]:
    """Return a colour per measure, or a dark and a light one per pair of measures."""
    dark_light = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00")
    return style.COLOURS[:count] if count < 4 else dark_light


def _span(rows: int) -> tuple[float, float]:
    return rows - 0.5, -0.5


def _rows(ax: Axes, names: list[str], *, named: bool) -> None:
    """List the parameters from top to bottom."""
    ax.set_yticks(range(len(names)))
    ax.yaxis.set_major_formatter(FixedFormatter([labels.parameter(name) for name in names]))
    ax.tick_params(axis="y", length=0, labelleft=named)
    ax.grid(visible=False, axis="y")
    ax.set_ylim(*_span(len(names)))


def _reach(ax: Axes, *, shares: bool) -> None:
    """Include zero, and one for shares."""
    low, high = ax.get_xlim()
    ax.set_xlim(min(low, 0.0), max(high, 1.0 if shares else 0.0))
    scales.linear(ax, "x")


def index_convergence(measure: Measure) -> Figure:
    """Return the figure of one measure against the number of samples, from their nested parts.

    It needs `<name>_by_samples` on (response, base_samples, parameter), and no new runs.
    """
    return Figure(
        f"{measure.name}_convergence",
        f"{labels.sentence(measure.words)} indices against the number of samples",
        partial(_convergence_applies, measure),
        partial(_plot_convergence, measure),
        partial(_convergence_caption, measure),
    )


def _by_samples(measure: Measure) -> str:
    return f"{measure.name}_by_samples"


def _convergence_applies(measure: Measure, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has the index from two sizes of the sample or more."""
    given = _by_samples(measure) in analysis and analysis.sizes[_SAMPLES] > 1
    return given and bool(analysed(runs, analysis))


def _convergence_caption(measure: Measure, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        f"The {measure.words} index from the first samples alone, up to all "
        f"{int(analysis[_SAMPLES].max())} base samples; bands: {access.confidence(analysis)} "
        "intervals, cut off outside −0.25 to 1.25. Indices that still drift beyond their bands "
        "at the right need more samples. "
        f"{access.missing_note(runs, analysed(runs, analysis))}".strip()
    )


@style.paper
def _plot_convergence(measure: Measure, runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a line with its band per parameter."""
    figure, axes = responses_grid.panels(analysed(runs, analysis), height=44)
    for name, ax in axes.items():
        _lines(ax, analysis, _by_samples(measure), name)
        ax.set_xscale("log", base=2)
        scales.at(ax, "x", analysis[_SAMPLES].values[::-2])
        _cut_off(ax)
        scales.linear(ax, "y")
        responses_grid.warn(ax, analysis, "sensitivity_verdict", name)
    figure.supxlabel("Base samples (–)")
    figure.supylabel("Share of the variance (–)")
    style.legend(figure)
    return figure


def _lines(ax: Axes, analysis: xr.Dataset, variable: str, response: str) -> None:
    values = analysis[variable].sel(response=response)
    margins = analysis.get(f"{variable}_interval")
    samples = analysis[_SAMPLES].values
    for at, name in enumerate(measures.parameters(analysis)):
        y = values.isel(parameter=at).values
        look = style.distinct(at)
        if np.isfinite(y).any():
            ax.plot(samples, y, label=labels.parameter(name), markersize=2.5, **look)
        if margins is not None:
            m = margins.sel(response=response).isel(parameter=at).values
            ax.fill_between(samples, y - m, y + m, color=look["color"], alpha=0.15, linewidth=0)
    if not ax.lines:
        style.remark(ax, "no finite values")


def _cut_off(ax: Axes) -> None:
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, _ENDS[0]), min(high, _ENDS[1]))
