"""The figure of repeated strikes: what each of them leaves, against its number."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, record, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Plan, Selection, plan
from impactlab.figures.labels import display
from impactlab.types import Floats

DENT = "permanent_indentation_over_strikes"
_DEFLECTION = "residual_deflection_over_strikes"
_PANELS = {
    DENT: "accumulated dent",
    _DEFLECTION: "residual deflection",
    "restitution_over_strikes": "restitution",
    "rebound_velocity_over_strikes": "separation velocity",
}
_FROM_ZERO = (DENT, "restitution_over_strikes", "rebound_velocity_over_strikes")


def longest(runs: xr.Dataset) -> xr.Dataset:
    """Return the runs of the most strikes: the others are their beginning."""
    if "strikes" not in runs.dims:
        return runs
    return runs.isel(strikes=[int(runs["strikes"].values.argmax())])


def _plan(runs: xr.Dataset) -> Plan:
    return plan(longest(runs), DENT, along=["strike"])


def _meaning(runs: xr.Dataset) -> str:
    moving = "strike_interval" in runs.coords
    return (
        "The deflection is that at the next touch of the beam, which goes on moving; after the "
        "last strike there is none."
        if moving
        else "The beam is at rest before each strike."
    )


def _sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, ...]:
    rings = "Rings: the strike from which on neither dent nor deflection grows."
    missing = access.missing_note(longest(runs), [DENT])
    return rings, _meaning(runs), _plan(runs).note(runs), missing


def _applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return DENT in runs


@record.figure(
    "Accumulated dent",
    "Dent after all strikes so far against the number of the strike.",
    _applies,
    _sentences,
    record.LEAD,
)
def accumulated_dent(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw the dent alone, to open a report."""
    return _draw(runs, [DENT])


@record.figure(
    "What each strike leaves",
    "Dent after all strikes so far, residual deflection of the axis under the sphere, coefficient "
    "of restitution and the sphere's velocity when it leaves, against the number of the strike.",
    _applies,
    _sentences,
)
def strike_series(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per answer, and a curve per run or value of what is varied."""
    return _draw(runs, [*_PANELS])


def _draw(runs: xr.Dataset, names: Sequence[str]) -> Figure:
    selected, shown = _plan(runs), longest(runs)
    figure, axes = style.panels(len(names), columns=min(len(names), 2), height=56, sharex=True)
    for ax, name in zip(axes, names, strict=True):
        valid = usable(shown, name)
        if name == _DEFLECTION and "strike_interval" in shown.coords:
            valid = valid.where(shown["strike"] < shown["strikes"])  # the last one is at rest
        unit = display(valid)
        for curve in selected.curves:
            _add(ax, shown, unit(valid.isel(curve.where)), curve)
        ax.set_ylabel(labels.axis(_PANELS[name], unit.symbol))
        if not ax.lines:
            style.remark(ax)
            continue
        scales.fit(ax, "x", shown["strike"].values)
        scales.linear(ax, "y")
        if name in _FROM_ZERO and np.nanmin(scales.drawn(ax, "y")) >= 0.0:
            ax.set_ylim(bottom=0.0)
    return selected.finish(figure, labels.axis("number of the strike", ""))


def _add(ax: Axes, runs: xr.Dataset, y: Floats, curve: Selection) -> None:
    """Draw a curve over the strikes, with a ring where nothing grows any more."""
    x = runs["strike"].values
    if not curves.add(ax, x, y, curve, markers=np.isfinite(y).sum() <= _FEW):
        return
    strike = float(runs["steady_strike"].isel(curve.where))
    if np.isfinite(strike):
        look = curves.look(curve) | {"marker": "o", "markersize": 6.0, "linestyle": ""}
        look |= {"markerfacecolor": "white", "markeredgewidth": 1.2, "label": "_steady"}
        ax.plot([strike], y[x == strike], **look)


_FEW = 12
"""Most strikes with a marker each."""
