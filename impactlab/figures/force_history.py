"""Contact force against time."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import curves, scales, style
from impactlab.figures.reading import missing, words
from impactlab.figures.reading.units import display

TITLE = "Contact force against time"
_FORCE = "contact_force"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept histories."""
    return _FORCE in runs


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    choice = f"{curves.note(runs, _FORCE)} {missing.note(runs, [_FORCE])}"
    return f"Contact force from first touch on. {choice}".strip()


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a run, up to the end of the last contact."""
    force, time = display(runs[_FORCE]), display(runs["time"])

    def line(run: xr.Dataset) -> curves.Points:
        return time(run["time"]), force(run[_FORCE])

    figure, axes = curves.draw(runs, _FORCE, line)
    curves.label(
        axes,
        words.axis("time since first touch", time.symbol),
        words.axis("contact force", force.symbol),
    )
    ends = [
        _end(np.asarray(c.get_xdata()), np.asarray(c.get_ydata())) for a in axes for c in a.lines
    ]
    for ax in axes:
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        ax.set(xlim=(0.0, 1.05 * max(ends, default=0.0) or None), ylim=(0.0, None))
    return curves.finish(figure, runs, _FORCE)


def _end(time: np.ndarray, force: np.ndarray) -> float:
    """The last time in contact, or of the history if there is no contact."""
    inside = np.flatnonzero(force > 0)
    return float(time[inside[-1] if inside.size else -1])
