"""Equivalent plastic strain along the beam."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import curves, labels, profiles, scales, style
from impactlab.figures.labels import display
from impactlab.figures.profiles import LOWEST, PAPER_LIMIT, STRAIN

TITLE = "Equivalent plastic strain along the beam"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept profiles."""
    return profiles.applies(runs)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Equivalent plastic strain (PEEQ) along the beam at the end of the run, the largest over "
        "the depth at each place. Dotted: one beam depth from the impact; dashed: the paper's "
        f"{PAPER_LIMIT} %. {profiles.note(runs)}"
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a run; zeros have no place on the logarithmic axis and leave a gap."""
    kept = profiles.plastic(runs)
    strain, place = display(kept[STRAIN]), display(kept["x"])

    def line(run: xr.Dataset) -> curves.Points:
        largest = run[STRAIN].max("z").dropna("x")
        return place(largest["x"]), strain(largest.where(largest > 0))

    figure, axes = curves.draw(kept, STRAIN, line)
    curves.label(
        axes, labels.axis("distance from the left support", place.symbol), labels.axis("PEEQ", "%")
    )
    marks = [place.scale * mark for mark in profiles.depth_marks(kept)]
    for ax in axes:
        _finish(ax, marks)
    return curves.finish(figure, kept, STRAIN)


def _finish(ax: Axes, marks: list[float]) -> None:
    values = [value for line in ax.lines for value in np.asarray(line.get_ydata())]
    scales.linear(ax, "x")
    if np.isfinite(values).any():
        top = 2 * max(float(np.nanmax(values)), PAPER_LIMIT)
        scales.logarithmic(ax, "y", [LOWEST, top])
        ax.set_ylim(LOWEST, top)
    elif ax.lines:
        style.remark(ax, "no plastic strain")
    for mark in marks:
        ax.axvline(mark, linestyle=":", label="_guide", **style.GUIDE)
    ax.axhline(PAPER_LIMIT, linestyle="--", label="_guide", **style.GUIDE)
