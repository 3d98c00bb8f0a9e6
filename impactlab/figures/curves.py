"""Curves of chosen runs, in a panel a contact law: what the figures of histories share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import style
from impactlab.figures.reading import missing, words
from impactlab.figures.reading.contents import design_dims, usable
from impactlab.figures.reading.plan import Choice, Plan, plan

Points = tuple[NDArray[np.float64], NDArray[np.float64]]
Line = Callable[[xr.Dataset], Points]
"""From one run's dataset (no design dimensions) to the x and y of its curve."""


def chosen(runs: xr.Dataset, variable: str) -> Plan:
    """A panel a contact law, a curve for each of some velocities (or what else is varied).

    Where nothing else is varied, the laws are the curves.
    """
    others = [dim for dim in design_dims(runs, runs[variable].dims) if dim != "contact"]
    alone = all(runs.sizes[dim] == 1 for dim in others)
    return plan(runs, variable, panel=None if alone else "contact")


def look(curve: Choice) -> dict[str, Any]:
    """Colour by the first shown dimension, line style by the second (or else the first).

    Later curves lie below, for they are the larger ones where the values rise.
    """
    colour, line = curve.place
    again = colour // len(style.COLOURS)  # one further each time round
    return {
        "color": style.COLOURS[colour % len(style.COLOURS)],
        "linestyle": style.LINES[(line + again) % len(style.LINES)],
        "zorder": 3.0 - 0.01 * colour - 0.001 * line,
    }


def marked(curve: Choice) -> dict[str, Any]:
    """The look with markers, for few points."""
    colour, line = curve.place
    again = colour // len(style.COLOURS)
    return look(curve) | {"marker": style.MARKERS[(line + again) % len(style.MARKERS)]}


def draw(
    runs: xr.Dataset, variable: str, line: Line, *, markers: bool = False
) -> tuple[Figure, list[Axes]]:
    """Draw each chosen run that has finite values; the others leave a gap.

    variable: the one that a run cannot do without.
    """
    selected = chosen(runs, variable)
    valid = runs.assign({variable: usable(runs, variable)})
    count = len(selected.panels)
    figure, axes = style.panels(count, columns=min(count, 3), height=62, sharex=True, sharey=True)
    for ax, panel in zip(axes, selected.panels, strict=True):
        ax.set_title(words.sentence(panel.label), loc="left")
        for curve in selected.curves:
            run = valid.isel(selected.runs(panel, curve))
            if np.isfinite(run[variable]).any():
                kind = marked(curve) if markers else look(curve)
                ax.plot(*line(run), label=curve.label or "_only", **kind)
        if not ax.lines:
            style.remark(ax, "no finite values")
    return figure, axes


def label(axes: Sequence[Axes], x: str, y: str) -> None:
    """Axis labels: x below each column, y at the left of each row."""
    for ax in axes:
        place = ax.get_subplotspec()
        assert place is not None
        ax.label_outer(remove_inner_ticks=False)
        if place.is_first_col():
            ax.set_ylabel(y)
        ax.set_xlabel(x)


def finish(figure: Figure, runs: xr.Dataset, variable: str) -> Figure:
    """Add the legend of the curves."""
    selected = chosen(runs, variable)
    style.legend(figure, selected.title(), selected.labels())
    return figure


def note(runs: xr.Dataset, variable: str) -> str:
    """What a caption says of the choice: curves, what is held, chosen runs without a curve."""
    selected = chosen(runs, variable)
    gaps = words.listing(_gaps(runs, variable, selected))
    return f"{selected.note(runs)} {f'No curve for {gaps}.' if gaps else ''}".strip()


def _gaps(runs: xr.Dataset, variable: str, selected: Plan) -> list[str]:
    """The chosen runs that have no finite value, by label."""
    absent = missing.absent(usable(runs, variable))
    return [
        ", ".join(filter(None, (curve.label, panel.label)))
        for panel in selected.panels
        for curve in selected.curves
        if bool(absent.isel(selected.runs(panel, curve)))
    ]
