"""Contact force during the first contact, which the whole history shows as a spike."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.labels import display

TITLE = "Contact force during the first contact"
_FORCE = "contact_force"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the study kept histories."""
    return _FORCE in runs


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Contact force from first touch to the end of the longest first contact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a run, up to the end of the longest first contact."""
    force, time = display(runs[_FORCE]), display(runs["time"])

    def line(run: xr.Dataset) -> curves.Points:
        return time(run["time"]), force(run[_FORCE])

    figure, axes = curves.draw(runs, _FORCE, line)
    curves.label(
        axes,
        labels.axis("time since first touch", time.symbol),
        labels.axis("contact force", force.symbol),
    )
    ends = [_end(curve) for ax in axes for curve in ax.lines]
    for ax in axes:
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        ax.set(xlim=(0.0, 1.05 * max(ends, default=0.0) or None), ylim=(0.0, None))
    return curves.finish(figure, runs, _FORCE)


def _end(curve: Line2D) -> float:
    """The time of the first sample out of contact, or of the last if the contact does not end."""
    time, force = (np.asarray(values, dtype=float) for values in curve.get_data())
    outside = np.flatnonzero(force[1:] <= 0)
    return float(time[outside[0] + 1 if outside.size else -1])
