"""Curves of chosen runs: which runs of a large grid a figure shows, and how their curves look."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import access, labels, style
from impactlab.figures.access import design_dims, usable

Points = tuple[NDArray[np.float64], NDArray[np.float64]]
Line = Callable[[xr.Dataset], Points]
"""From one run's dataset (no design dimensions) to the x and y of its curve."""


_LARGE, _SMALL = ("nodes", "points", "elements_per_radius"), ("courant", "element_size")
MOST_CURVES = 6
MOST_PANELS = 6


@dataclass(frozen=True)
class Choice:
    """Positions on design dimensions, their label, and ordinals (colour, line style) to draw by."""

    where: dict[str, int]
    label: str
    place: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Plan:
    """The panels and curves of a figure.

    shown: positions by dimension. held: dimensions fixed at one position.
    """

    panels: list[Choice]
    curves: list[Choice]
    shown: dict[str, list[int]]
    held: dict[str, int]

    def runs(self, panel: Choice, curve: Choice) -> dict[str, int]:
        """Return the indexers of a curve in a panel, for `isel`."""
        return self.held | panel.where | curve.where

    def title(self) -> str:
        """Return the legend's title, the parameters in which the curves differ."""
        return labels.sentence(", ".join(labels.parameter(dim) for dim in self.shown))

    def labels(self) -> list[str]:
        """Return the curves' labels, in order."""
        return [curve.label for curve in self.curves]

    def note(self, runs: xr.Dataset) -> str:
        """Return a caption's sentences on the values that are shown and held."""
        shown = [labels.setting(runs[dim], where) for dim, where in self.shown.items()]
        held = [labels.setting(runs[dim], [at]) for dim, at in self.held.items()]
        text = f"Curves: {'; '.join(shown)}." if shown else ""
        return f"{text} Held: {'; '.join(held)}.".strip() if held else text


def plan(
    runs: xr.Dataset,
    variable: str,
    *,
    along: Sequence[str] = (),
    panel: str | None = None,
    prefer: Sequence[str] = ("velocity",),
    most: int = MOST_CURVES,
) -> Plan:
    """Choose what to show of a variable of the runs.

    along: design dimensions on an axis of the figure. panel: the dimension that gets a panel
    per value. prefer: dimensions that get curves first. most: the largest number of curves.
    """
    dims = [dim for dim in design_dims(runs, runs[variable].dims) if dim not in along]
    panels = _panels(runs, panel) if panel in dims else [Choice({}, "")]
    left = sorted((dim for dim in dims if dim != panel), key=lambda dim: _rank(dim, prefer))
    shown = _shown({dim: runs.sizes[dim] for dim in left if runs.sizes[dim] > 1}, most)
    held = {d: _held(runs[d]) for d in left if d not in shown and runs.sizes[d] > 1}
    single = {dim: 0 for dim in left if runs.sizes[dim] == 1}
    return Plan(panels, _curves(runs, shown, single), shown, held)


def _shown(sizes: dict[str, int], most: int) -> dict[str, list[int]]:
    """Return positions on at most two dimensions; the first leaves room for two of the second."""
    shown: dict[str, list[int]] = {}
    room = min(most, max(most // 2, 2)) if len(sizes) > 1 else most
    for dim, size in list(sizes.items())[:2]:
        if min(size, room) > 1:
            shown[dim] = spread(size, min(size, room))
        room = most // len(shown.get(dim, [0]))
    return shown


def spread(size: int, count: int) -> list[int]:
    """Return `count` positions of `size`, evenly spread, with the first and the last."""
    return [int(at) for at in np.unique(np.linspace(0, size - 1, count).round())]


def _panels(runs: xr.Dataset, dim: str | None) -> list[Choice]:
    where = spread(runs.sizes[dim], min(runs.sizes[dim], MOST_PANELS))
    return [Choice({str(dim): at}, labels.value(runs[dim], at)) for at in where]


def _curves(runs: xr.Dataset, shown: dict[str, list[int]], single: dict[str, int]) -> list[Choice]:
    chosen = []
    for ordinals in product(*(range(len(where)) for where in shown.values())):
        where = {dim: shown[dim][i] for dim, i in zip(shown, ordinals, strict=True)}
        label = ", ".join(labels.value(runs[dim], at) for dim, at in where.items())
        place = (*ordinals, *ordinals[:1], 0, 0) if len(ordinals) < 2 else ordinals
        chosen.append(Choice(where | single, label, (place[0], place[1])))
    return chosen


def _rank(dim: str, prefer: Sequence[str]) -> int:
    return prefer.index(dim) if dim in prefer else len(prefer)


def _held(coordinate: xr.DataArray) -> int:
    """Return the position of the finest numerics, the middle number, or the first name."""
    if coordinate.name in _SMALL:
        return int(np.argmin(coordinate.values))
    if coordinate.name in _LARGE:
        return int(np.argmax(coordinate.values))
    return coordinate.size // 2 if coordinate.dtype.kind in "if" else 0


def chosen(runs: xr.Dataset, variable: str) -> Plan:
    """Plan a panel per contact law, a curve for each of some velocities (or what else is varied).

    Where nothing else is varied, the laws are the curves.
    """
    others = [dim for dim in design_dims(runs, runs[variable].dims) if dim != "contact"]
    alone = all(runs.sizes[dim] == 1 for dim in others)
    return plan(runs, variable, panel=None if alone else "contact")


def look(curve: Choice) -> dict[str, Any]:
    """Return the colour by the first shown dimension, the line style by the second (or the first).

    Later curves lie below, as they are the larger ones where the values rise.
    """
    colour, line = curve.place
    again = colour // len(style.COLOURS)  # one further each time round
    return {
        "color": style.COLOURS[colour % len(style.COLOURS)],
        "linestyle": style.LINES[(line + again) % len(style.LINES)],
        "zorder": 3.0 - 0.01 * colour - 0.001 * line,
    }


def marked(curve: Choice) -> dict[str, Any]:
    """Return the look with markers, for few points."""
    colour, line = curve.place
    again = colour // len(style.COLOURS)
    return look(curve) | {"marker": style.MARKERS[(line + again) % len(style.MARKERS)]}


def draw(
    runs: xr.Dataset, variable: str, line: Line, *, markers: bool = False
) -> tuple[Figure, list[Axes]]:
    """Draw each chosen run that has finite values; the others leave a gap.

    variable: runs without finite values of it have no curve.
    """
    selected = chosen(runs, variable)
    valid = runs.assign({variable: usable(runs, variable)})
    count = len(selected.panels)
    figure, axes = style.panels(count, columns=min(count, 3), height=62, sharex=True, sharey=True)
    for ax, panel in zip(axes, selected.panels, strict=True):
        ax.set_title(labels.sentence(panel.label), loc="left")
        for curve in selected.curves:
            run = valid.isel(selected.runs(panel, curve))
            if np.isfinite(run[variable]).any():
                kind = marked(curve) if markers else look(curve)
                ax.plot(*line(run), label=curve.label or "_only", **kind)
        if not ax.lines:
            style.remark(ax, "no finite values")
    return figure, axes


def label(axes: Sequence[Axes], x: str, y: str) -> None:
    """Label the axes: x below each column, y at the left of each row."""
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
    """Return a caption's sentences on the curves, what is held, and chosen runs without a curve."""
    selected = chosen(runs, variable)
    gaps = labels.listing(_gaps(runs, variable, selected))
    return f"{selected.note(runs)} {f'No curve for {gaps}.' if gaps else ''}".strip()


def _gaps(runs: xr.Dataset, variable: str, selected: Plan) -> list[str]:
    """Return the labels of the chosen runs that have no finite value."""
    absent = access.absent(usable(runs, variable))
    return [
        ", ".join(filter(None, (curve.label, panel.label)))
        for panel in selected.panels
        for curve in selected.curves
        if bool(absent.isel(selected.runs(panel, curve)))
    ]
