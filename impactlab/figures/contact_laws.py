"""Contact laws side by side: force against indentation, restitution and dent against velocity."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, usable
from impactlab.figures.curves import Choice, Plan, plan
from impactlab.figures.labels import display
from impactlab.variables import MARKS

TITLE = "Contact laws side by side"
_FEWEST = 3
_FORCE, _INDENTATION = "contact_force", "indentation"
_DENT = "permanent_indentation"
_AGAINST_VELOCITY = ("restitution", _DENT)
_OUTSIDE = MARKS["outside_contact_law"][0]


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether a grid has at least three contact laws and three velocities."""
    few = [dim for dim in ("contact", "velocity") if runs.sizes.get(dim, 0) < _FEWEST]
    return not is_sample(runs) and not few and bool(_variables(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    at = labels.value(runs["velocity"], _middle(runs)) if _has_histories(runs) else ""
    force = f"Force against indentation at {at}, while in contact. " if at else ""
    logarithmic = "Permanent indentations of zero or below are not shown. " * (_DENT in runs)
    beyond = bool(((runs["status"] & _OUTSIDE) != 0).any())
    open_markers = "Open markers: beyond the range of the law. " if beyond else ""
    return (
        f"{force}{logarithmic}{open_markers}{_plan(runs).note(runs)} "
        f"{access.missing_note(runs, _variables(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel for the histories and one for each response, a colour a law."""
    selected = _plan(runs)
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


def _plan(runs: xr.Dataset) -> Plan:
    """Every law has its curve."""
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
    """Over the marker, without a label or a line."""
    return curves.marked(curve) | {"linestyle": "", "markerfacecolor": "white", "label": "_open"}
