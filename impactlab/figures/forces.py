"""Figures of histories: contact force, displacements and indentation of single runs."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Choice, Plan, plan
from impactlab.figures.labels import Display, display
from impactlab.figures.record import Figure

_FORCE, _INDENTATION = "contact_force", "indentation"
_FEW, _MANY = 32.0, 21.0
"""Height of a row of panels where there are few or many rows, mm."""
_COLUMNS_OF_HISTORIES = 4
_WIDE = 3
"""Columns up to which a panel's title has room on one line."""
_DISPLACEMENTS = {
    "sphere_displacement": "sphere",
    "midspan_deflection": "beam at mid-span",
    "indentation": "indentation",
}
_COLUMNS = 2
"""Of the panels of force against indentation by law."""


def _has_force(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return _FORCE in runs


def _first_contact_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Contact force from first touch to the end of the longest first contact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def _plot_first_contact(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a curve per run, up to the end of the longest first contact."""
    force, time = display(runs[_FORCE]), display(runs["time"])

    def line(run: xr.Dataset) -> curves.Points:
        return time(run["time"]), force(run[_FORCE])

    figure, axes = curves.draw(runs, _FORCE, line)
    curves.label(
        axes,
        labels.axis("time since first touch", time.symbol),
        labels.axis("contact force", force.symbol),
    )
    ends = [_end_of_contact(curve) for ax in axes for curve in ax.lines]
    for ax in axes:
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        ax.set(xlim=(0.0, 1.05 * max(ends, default=0.0) or None), ylim=(0.0, None))
    return curves.finish(figure, runs, _FORCE)


def _end_of_contact(curve: Line2D) -> float:
    """Return the time of the first sample out of contact, or else of the last sample."""
    time, force = (np.asarray(values, dtype=float) for values in curve.get_data())
    outside = np.flatnonzero(force[1:] <= 0)
    return float(time[outside[0] + 1 if outside.size else -1])


FIRST_CONTACT = Figure(
    "first_contact",
    "Contact force during the first contact",
    _has_force,
    _plot_first_contact,
    _first_contact_caption,
)


def _history_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Contact force from first touch to the end of the last contact; each panel has a scale of "
        "force of its own, and a peak after a gap is a sub-impact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def _plot_history(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per run, as sub-impacts would hide each other; a row or more per velocity."""
    selected, force = curves.chosen(runs, _FORCE), usable(runs, _FORCE)
    shown = [(panel, curve) for curve in selected.curves for panel in selected.panels]
    rows = math.ceil(len(selected.panels) / _COLUMNS_OF_HISTORIES)
    columns = math.ceil(len(selected.panels) / rows)
    height = _FEW if len(shown) <= 3 * columns else _MANY
    figure, axes = style.panels(len(shown), columns=columns, height=height, sharex=True)
    between = ", " if columns <= _WIDE else "\n"
    for ax, (panel, curve) in zip(axes, shown, strict=True):
        texts = (labels.sentence(panel.label), curve.label)
        ax.set_title(between.join(filter(None, texts)), loc="left")
        _draw_force(ax, force.isel(selected.runs(panel, curve)), runs, curve)
    units = display(runs[_FORCE]).symbol, display(runs["time"]).symbol
    figure.supylabel(labels.axis("contact force", units[0]))
    figure.supxlabel(labels.axis("time since first touch", units[1]))
    axes[0].set_xlim(0.0, 1.02 * _end_of_contacts(axes) or None)
    return figure


def _draw_force(ax: Axes, force: xr.DataArray, runs: xr.Dataset, curve: Choice) -> None:
    scales.linear(ax, "x")
    scales.linear(ax, "y", ticks=3)
    if np.isfinite(force).any():
        time, unit = display(runs["time"]), display(runs[_FORCE])
        look = curves.look(curve) | {"linestyle": "-", "linewidth": 0.9}
        ax.plot(time(runs["time"]), unit(force), label=curve.label or "_only", **look)
        ax.set_ylim(0.0, None)
    else:
        style.remark(ax, "no finite values")


def _end_of_contacts(axes: list[Axes]) -> float:
    """Return the last time in contact over all panels."""
    last = 0.0
    for line in (line for ax in axes for line in ax.lines):
        inside = np.flatnonzero(np.asarray(line.get_ydata()) > 0)
        if inside.size:
            last = max(last, float(np.asarray(line.get_xdata())[inside[-1]]))
    return last


FORCE_HISTORY = Figure(
    "force_history",
    "Contact force against time",
    _has_force,
    _plot_history,
    _history_caption,
)


def _displacements_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether histories were kept, of no more contact laws than panels fit side by side."""
    kept = all(name in runs for name in _DISPLACEMENTS)
    return kept and len(curves.chosen(runs, next(iter(_DISPLACEMENTS))).panels) <= _WIDE


def _displacements_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    names = list(_DISPLACEMENTS)
    return (
        "Displacement of the sphere since first touch, deflection of the beam at mid-span, and "
        "their difference, the indentation (below zero: the two are apart); downwards is positive. "
        f"{curves.note(runs, names[0])} {access.missing_note(runs, names)}".strip()
    )


@style.paper
def _plot_displacements(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per run, in a column per contact law."""
    selected = curves.chosen(runs, next(iter(_DISPLACEMENTS)))
    shown = [(panel, curve) for curve in selected.curves for panel in selected.panels]
    columns = len(selected.panels) if len(selected.panels) > 1 else min(len(shown), 2)
    figure, axes = style.panels(len(shown), columns=columns, height=45, sharex=True)
    unit = display(runs["midspan_deflection"])
    for ax, (panel, curve) in zip(axes, shown, strict=True):
        texts = (labels.sentence(panel.label), curve.label)
        ax.set_title(", ".join(filter(None, texts)), loc="left")
        _draw_displacements(ax, runs, selected.runs(panel, curve), unit)
    figure.supylabel(labels.axis("displacement", unit.symbol))
    figure.supxlabel(labels.axis("time since first touch", display(runs["time"]).symbol))
    style.legend(figure, order=list(_DISPLACEMENTS.values()))
    return figure


def _draw_displacements(ax: Axes, runs: xr.Dataset, where: dict[str, int], unit: Display) -> None:
    scales.linear(ax, "x")
    scales.linear(ax, "y")
    time = display(runs["time"])(runs["time"])
    for at, (name, label) in enumerate(_DISPLACEMENTS.items()):
        values = usable(runs, name).isel(where)
        if np.isfinite(values).any():
            ax.plot(
                time, unit(values), label=label, color=style.COLOURS[at], linestyle=style.LINES[at]
            )
    if not ax.lines:
        style.remark(ax, "no finite values")
        return
    ax.set_xlim(0.0, float(time[-1]))
    ax.axhline(0.0, label="_guide", linestyle="-", **style.GUIDE)


DISPLACEMENT_HISTORY = Figure(
    "displacement_history",
    "Displacements against time",
    _displacements_applies,
    _plot_displacements,
    _displacements_caption,
)


def _has_loops(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return _FORCE in runs and _INDENTATION in runs


def _loops_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Contact force against indentation while in contact; each sub-impact is a loop of its "
        "own, and the area inside is the energy dissipated in the contact. "
        f"{curves.note(runs, _FORCE)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def _plot_loops(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a curve per run, broken where sphere and beam are apart."""
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])

    def line(run: xr.Dataset) -> curves.Points:
        return _loop(run, depth, force)

    figure, axes = curves.draw(runs, _FORCE, line)
    curves.label(
        axes, labels.axis("indentation", depth.symbol), labels.axis("contact force", force.symbol)
    )
    for ax in axes:
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        ax.set(xlim=(0.0, None), ylim=(0.0, None))
    return curves.finish(figure, runs, _FORCE)


def _loop(run: xr.Dataset, depth: Display, force: Display) -> curves.Points:
    """Return indentation and force of one run in display units, NaN where the two are apart."""
    values = run[_FORCE].values
    apart = ~_touching(values)
    return depth(run[_INDENTATION].where(~apart)), force(np.where(apart, np.nan, values))


def _touching(force: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return True in contact and one sample to either side, so that loops reach the axis."""
    inside = force > 0
    before, after = np.roll(inside, -1), np.roll(inside, 1)
    before[-1] = after[0] = False
    return inside | before | after


FORCE_INDENTATION = Figure(
    "force_indentation",
    "Contact force against indentation",
    _has_loops,
    _plot_loops,
    _loops_caption,
)


def _by_law_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether histories were kept of several contact laws at several velocities."""
    kept = _has_loops(runs, analysis)
    return kept and all(runs[_FORCE].sizes.get(dim, 0) > 1 for dim in ("contact", "velocity"))


def _by_law_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Contact force against indentation while in contact, each panel on scales of its own; the "
        "area inside a loop is the energy dissipated in the contact. "
        f"{_plan_by_law(runs).note(runs)} {access.missing_note(runs, [_FORCE])}".strip()
    )


@style.paper
def _plot_by_law(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a curve per contact law, broken where sphere and beam are apart."""
    selected, valid = _plan_by_law(runs), runs.assign({_FORCE: usable(runs, _FORCE)})
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    count = len(selected.panels)
    figure, axes = style.panels(count, columns=min(count, _COLUMNS), height=58)
    for ax, panel in zip(axes, selected.panels, strict=True):
        ax.set_title(f"At {panel.label}", loc="left")
        for curve in selected.curves:
            run = valid.isel(selected.runs(panel, curve))
            x, y = _loop(run, depth, force)
            if np.isfinite(y).any():
                ax.plot(x, y, label=curve.label or "_only", **curves.look(curve))
        scales.linear(ax, "x")
        scales.linear(ax, "y")
        if ax.lines:
            ax.set(xlim=(0.0, None), ylim=(0.0, None))
        else:
            style.remark(ax, "no finite values")
    figure.supxlabel(labels.axis("indentation", depth.symbol))
    figure.supylabel(labels.axis("contact force", force.symbol))
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _plan_by_law(runs: xr.Dataset) -> Plan:
    return plan(runs, _FORCE, panel="velocity", prefer=["contact"])


FORCE_INDENTATION_BY_LAW = Figure(
    "force_indentation_by_law",
    "Contact force against indentation under each contact law",
    _by_law_applies,
    _plot_by_law,
    _by_law_caption,
)
