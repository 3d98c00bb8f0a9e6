"""Duration of the first contact against velocity."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Plan, plan
from impactlab.figures.labels import display

TITLE = "Contact duration against velocity"
_DURATION = "contact_duration"
_FEWEST = 3


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether contact_duration is on a grid of at least three velocities."""
    return _DURATION in runs and runs[_DURATION].sizes.get("velocity", 0) >= _FEWEST


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Duration of the first contact (a later sub-impact does not count) against the impact "
        "velocity. Grey: the slope −1/5 of Hertz's elastic impact on a half-space. "
        f"{_plan(runs).note(runs)} {access.missing_note(runs, [_DURATION])}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A curve a contact law, or what else is varied."""
    selected, valid = _plan(runs), usable(runs, _DURATION)
    unit, speed = display(valid.rename(_DURATION)), runs["velocity"].values
    figure, (ax,) = style.panels(1, columns=1, height=62)
    for curve in selected.curves:
        values = unit(valid.isel(selected.held | curve.where))
        if np.isfinite(values).any():
            ax.plot(speed, values, label=curve.label or "_only", **curves.marked(curve))
    ax.set_xlabel(labels.axis(labels.parameter("velocity"), "m/s"))
    ax.set_ylabel(labels.axis("duration of the first contact", unit.symbol))
    _scale(ax, speed)
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _plan(runs: xr.Dataset) -> Plan:
    return plan(runs, _DURATION, along=["velocity"], prefer=["contact"])


def _scale(ax: Axes, speed: np.ndarray) -> None:
    """Both axes logarithmic, for durations follow powers of the velocity; then the guide."""
    lines = list(ax.lines)
    if not lines:
        style.remark(ax, "no finite values")
        return
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in lines])
    scales.logarithmic(ax, "x", speed)
    scales.logarithmic(ax, "y", values)
    highest, ends = np.nanmax(values), np.array([speed.min(), speed.max()])
    guide = highest * (ends / ends[0]) ** -0.2 * 1.08
    ax.plot(ends, guide, label="_guide", linestyle="-", **style.GUIDE)
