"""Figures of grids against the impact velocity, with a curve per contact law."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure

from impactlab.figures import access, curves, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, usable
from impactlab.figures.curves import Choice, Plan, plan
from impactlab.figures.labels import display
from impactlab.figures.record import Figure
from impactlab.variables import MARKS

_DURATION, _RESTITUTION = "contact_duration", "restitution"
_FEWEST = 3
_FORCE, _INDENTATION = "contact_force", "indentation"
_DENT = "permanent_indentation"
_AGAINST_VELOCITY = (_RESTITUTION, _DENT)
_OUTSIDE = MARKS["outside_contact_law"][0]


def _on_velocities(runs: xr.Dataset, name: str) -> bool:
    """Return whether a response is on a grid of at least three velocities."""
    return name in runs and runs[name].sizes.get("velocity", 0) >= _FEWEST


def _curves(runs: xr.Dataset, name: str, label: str) -> tuple[MplFigure, Axes]:
    """Draw a curve per contact law, or per value of what else is varied."""
    selected, valid = _plan_curves(runs, name), usable(runs, name)
    unit, speed = display(valid.rename(name)), runs["velocity"].values
    figure, (ax,) = style.panels(1, columns=1, height=62)
    for curve in selected.curves:
        values = unit(valid.isel(selected.held | curve.where))
        if np.isfinite(values).any():
            ax.plot(speed, values, label=curve.label or "_only", **curves.marked(curve))
    ax.set_xlabel(labels.axis(labels.parameter("velocity"), "m/s"))
    ax.set_ylabel(labels.axis(label, unit.symbol))
    style.legend(figure, selected.title(), selected.labels())
    return figure, ax


def _plan_curves(runs: xr.Dataset, name: str) -> Plan:
    return plan(runs, name, along=["velocity"], prefer=["contact"])


def _notes(runs: xr.Dataset, name: str) -> str:
    return f"{_plan_curves(runs, name).note(runs)} {access.missing_note(runs, [name])}".strip()


def _duration_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return _on_velocities(runs, _DURATION)


def _duration_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Duration of the first contact (a later sub-impact does not count) against the impact "
        "velocity. Grey: the slope −1/5 of Hertz's elastic impact on a half-space. "
        f"{_notes(runs, _DURATION)}".strip()
    )


@style.paper
def _plot_duration(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    figure, ax = _curves(runs, _DURATION, "duration of the first contact")
    _scale(ax, runs["velocity"].values)
    return figure


def _scale(ax: Axes, speed: np.ndarray) -> None:
    """Make both axes logarithmic, as durations follow powers of the velocity; add the guide."""
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


CONTACT_DURATION = Figure(
    "contact_duration",
    "Contact duration against velocity",
    _duration_applies,
    _plot_duration,
    _duration_caption,
)


def _restitution_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return _on_velocities(runs, _RESTITUTION)


def _restitution_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Coefficient of restitution, the sphere's rebound velocity over its impact velocity, "
        f"against the impact velocity. {_notes(runs, _RESTITUTION)}".strip()
    )


@style.paper
def _plot_restitution(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    figure, ax = _curves(runs, _RESTITUTION, labels.response(_RESTITUTION))
    if not ax.lines:
        style.remark(ax, "no finite values")
        return figure
    scales.fit(ax, "x", runs["velocity"].values)
    scales.linear(ax, "y")
    ax.set_ylim(min(0.0, ax.get_ylim()[0]), max(1.0, ax.get_ylim()[1]))
    return figure


RESTITUTION_VELOCITY = Figure(
    "restitution_velocity",
    "Restitution against velocity",
    _restitution_applies,
    _plot_restitution,
    _restitution_caption,
)


def _laws_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether a grid has at least three contact laws and three velocities."""
    few = [dim for dim in ("contact", "velocity") if runs.sizes.get(dim, 0) < _FEWEST]
    return not is_sample(runs) and not few and bool(_variables(runs))


def _laws_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    at = labels.value(runs["velocity"], _middle(runs)) if _has_histories(runs) else ""
    force = f"Force against indentation at {at}, while in contact. " if at else ""
    logarithmic = "Permanent indentations of zero or below are not shown. " * (_DENT in runs)
    beyond = bool(((runs["status"] & _OUTSIDE) != 0).any())
    open_markers = "Open markers: beyond the range of the law. " if beyond else ""
    return (
        f"{force}{logarithmic}{open_markers}{_plan_laws(runs).note(runs)} "
        f"{access.missing_note(runs, _variables(runs))}".strip()
    )


@style.paper
def _plot_laws(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel of histories and one per response, with a colour per law."""
    selected = _plan_laws(runs)
    names = [name for name in _AGAINST_VELOCITY if name in runs]
    count = len(names) + _has_histories(runs)
    figure, axes = style.panels(count, columns=max(count, 2), height=62)
    if _has_histories(runs):
        _forces(axes[0], runs, selected)
    for ax, name in zip(axes[-len(names) :] if names else [], names, strict=True):
        _against_velocity(ax, runs, name, selected)
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _has_histories(runs: xr.Dataset) -> bool:
    return _FORCE in runs and _INDENTATION in runs


def _variables(runs: xr.Dataset) -> list[str]:
    return [_FORCE] * _has_histories(runs) + [name for name in _AGAINST_VELOCITY if name in runs]


def _middle(runs: xr.Dataset) -> int:
    return runs.sizes["velocity"] // 2


def _plan_laws(runs: xr.Dataset) -> Plan:
    """Plan a curve for every law."""
    laws = runs.sizes["contact"]
    return plan(runs, "status", along=["velocity"], prefer=["contact"], most=laws)


def _forces(ax: Axes, runs: xr.Dataset, selected: Plan) -> None:
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    valid = usable(runs, _FORCE)
    for curve in selected.curves:
        where = selected.held | curve.where | {"velocity": _middle(runs)}
        values = valid.isel(where).values
        touching = values > 0
        if touching.any():
            x = depth(runs[_INDENTATION].isel(where).values[touching])
            ax.plot(x, force(values[touching]), label=curve.label, **curves.look(curve))
    ax.set_xlabel(labels.axis("indentation", depth.symbol))
    ax.set_ylabel(labels.axis("contact force", force.symbol))
    if not ax.lines:
        responses_grid.empty(ax, "no finite values")
        return
    scales.linear(ax, "x")
    scales.linear(ax, "y")
    ax.set(xlim=(0.0, None), ylim=(0.0, None))


def _against_velocity(ax: Axes, runs: xr.Dataset, name: str, selected: Plan) -> None:
    values, label = responses_grid.shown(runs, name)
    speed = runs["velocity"].values
    for curve in selected.curves:
        y = values.isel(selected.held | curve.where).values
        if np.isfinite(y).any():
            ax.plot(speed, y, label=curve.label, **curves.marked(curve))
            outside = _outside(runs, selected, curve)
            ax.plot(speed[outside], y[outside], **_open(curve))
    ax.set(xlabel=labels.axis("velocity", "m/s"), ylabel=label)
    if not ax.lines:
        responses_grid.empty(ax, "no finite values")
        return
    scales.fit(ax, "x", speed)
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    # dents span decades, and those of zero (Hertz) or below (some laws, just beyond yield) do not
    # matter beside the others
    (scales.logarithmic if name == _DENT else scales.fit)(ax, "y", drawn)


def _outside(runs: xr.Dataset, selected: Plan, curve: Choice) -> np.ndarray:
    status = runs["status"].isel(selected.held | curve.where).values
    outside: np.ndarray = (status & _OUTSIDE) != 0
    return outside


def _open(curve: Choice) -> dict[str, Any]:
    """Return the look of an open marker, drawn over the filled one."""
    return curves.marked(curve) | {"linestyle": "", "markerfacecolor": "white", "label": "_open"}


CONTACT_LAWS = Figure(
    "contact_laws",
    "Contact laws side by side",
    _laws_applies,
    _plot_laws,
    _laws_caption,
)
