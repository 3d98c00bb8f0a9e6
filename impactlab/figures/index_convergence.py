"""Sensitivity indices against the size of the sample, from its nested parts: no new runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, labels, measures, responses_grid, scales, style
from impactlab.figures.measures import Measure, asked

_SAMPLES = "base_samples"
_ENDS = (-0.25, 1.25)
"""The axis goes no further: intervals from few samples can be many times as wide as the whole."""


@dataclass(frozen=True)
class IndexConvergence:
    """The figure of one measure: `<name>_by_samples` on (response, base_samples, parameter)."""

    measure: Measure

    @property
    def TITLE(self) -> str:  # noqa: N802  (what every figure's file calls it)
        """Heads the figure."""
        return f"{labels.sentence(self.measure.words)} indices against the number of samples"

    @property
    def _variable(self) -> str:
        return f"{self.measure.name}_by_samples"

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Whether the analysis has the index from two sizes of the sample or more."""
        return (
            self._variable in analysis
            and analysis.sizes[_SAMPLES] > 1
            and bool(asked(runs, analysis))
        )

    def caption(self, runs: xr.Dataset, analysis: xr.Dataset) -> str:
        """What is shown."""
        return (
            f"The {self.measure.words} index from the first samples alone, up to all "
            f"{int(analysis[_SAMPLES].max())} base samples; bands: {access.confidence(analysis)} "
            "intervals, cut off outside −0.25 to 1.25. Indices that still drift beyond their bands "
            "at the right need more samples. "
            f"{access.missing_note(runs, asked(runs, analysis))}".strip()
        )

    @style.paper
    def plot(self, runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
        """A panel a response, a line with its band a parameter."""
        figure, axes = responses_grid.panels(asked(runs, analysis), height=44)
        for name, ax in axes.items():
            self._lines(ax, analysis, name)
            ax.set_xscale("log", base=2)
            scales.at(ax, "x", analysis[_SAMPLES].values[::-2])
            _reach(ax)
            scales.linear(ax, "y")
            responses_grid.warn(ax, analysis, "sensitivity_verdict", name)
        figure.supxlabel("Base samples (–)")
        figure.supylabel("Share of the variance (–)")
        style.legend(figure)
        return figure

    def _lines(self, ax: Axes, analysis: xr.Dataset, response: str) -> None:
        values = analysis[self._variable].sel(response=response)
        margins = analysis.get(f"{self._variable}_interval")
        samples = analysis[_SAMPLES].values
        for at, name in enumerate(measures.parameters(analysis)):
            y = values.isel(parameter=at).values
            look = style.told_apart(at)
            if np.isfinite(y).any():
                ax.plot(samples, y, label=labels.parameter(name), markersize=2.5, **look)
            if margins is not None:
                m = margins.sel(response=response).isel(parameter=at).values
                ax.fill_between(samples, y - m, y + m, color=look["color"], alpha=0.15, linewidth=0)
        if not ax.lines:
            style.remark(ax, "no finite values")


def _reach(ax: Axes) -> None:
    low, high = ax.get_ylim()
    ax.set_ylim(max(low, _ENDS[0]), min(high, _ENDS[1]))
