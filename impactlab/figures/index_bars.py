"""Sensitivity indices as bars: a panel a response, a row a parameter, a bar a measure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter

from impactlab.figures import access, labels, measures, responses_grid, scales, style
from impactlab.figures.measures import Family, asked

_THICK = 0.76
"""Of all bars of a row together, in rows."""
_PALE = 0.45
"""Opacity of bars that the dummy or the interval does not let stand."""


@dataclass(frozen=True)
class IndexBars:
    """The figure of one family of measures."""

    family: Family

    @property
    def TITLE(self) -> str:  # noqa: N802  (what every figure's file calls it)
        """Heads the figure."""
        return self.family.title

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Whether the analysis has these indices, for responses of these runs."""
        return self.family.given(analysis) and bool(asked(runs, analysis))

    def caption(self, runs: xr.Dataset, analysis: xr.Dataset) -> str:
        """What is shown, how to read it and what is missing."""
        return " ".join(
            filter(
                None,
                (
                    self.family.says,
                    _estimator(analysis, self.family),
                    f"Lines on the bars: {access.confidence(analysis)} intervals.",
                    _floor_words(analysis, self.family),
                    _numerical_words(analysis, self.family),
                    access.missing_note(runs, asked(runs, analysis)),
                ),
            )
        )

    @style.paper
    def plot(self, runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
        """A panel a response; bars within the noise are pale."""
        rows, bars = analysis.sizes["parameter"], len(self.family.measures_in(analysis))
        height = 10 + max(4.2, 1.4 * bars) * rows
        figure, axes = responses_grid.panels(asked(runs, analysis), height, beneath=8)
        for at, (name, ax) in enumerate(axes.items()):
            _bars(ax, analysis, self.family, name)
            undefined(ax, analysis, name, self.family.measures_in(analysis)[0].name)
            _rows(ax, measures.parameters(analysis), named=at % responses_grid.COLUMNS == 0)
            _reach(ax, shares=self.family.shares)
        figure.supxlabel(self.family.axis)
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
    """Two measures: two colours; two pairs: a dark and a light one each."""
    dark_light = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00")
    return style.COLOURS[:count] if count < 4 else dark_light


def _span(rows: int) -> tuple[float, float]:
    return rows - 0.5, -0.5


def _rows(ax: Axes, names: list[str], *, named: bool) -> None:
    """Parameters from top to bottom."""
    ax.set_yticks(range(len(names)))
    ax.yaxis.set_major_formatter(FixedFormatter([labels.parameter(name) for name in names]))
    ax.tick_params(axis="y", length=0, labelleft=named)
    ax.grid(visible=False, axis="y")
    ax.set_ylim(*_span(len(names)))


def _reach(ax: Axes, *, shares: bool) -> None:
    """Zero is always there; of shares, the whole is, too."""
    low, high = ax.get_xlim()
    ax.set_xlim(min(low, 0.0), max(high, 1.0 if shares else 0.0))
    scales.linear(ax, "x")
