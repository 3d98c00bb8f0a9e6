"""Which runs of a large grid a figure shows: a few curves, a few panels, the rest held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import xarray as xr

from impactlab.figures.reading import words
from impactlab.figures.reading.contents import design_dims

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
    """What is drawn. shown: positions by dimension; held: dimensions fixed at one position."""

    panels: list[Choice]
    curves: list[Choice]
    shown: dict[str, list[int]]
    held: dict[str, int]

    def runs(self, panel: Choice, curve: Choice) -> dict[str, int]:
        """The indexers of a curve in a panel, for `isel`."""
        return self.held | panel.where | curve.where

    def title(self) -> str:
        """A legend's title: what tells the curves apart."""
        return words.sentence(", ".join(words.parameter(dim) for dim in self.shown))

    def labels(self) -> list[str]:
        """The curves' labels, in order."""
        return [curve.label for curve in self.curves]

    def note(self, runs: xr.Dataset) -> str:
        """A caption's sentences: which values are shown and which are held."""
        shown = [words.setting(runs[dim], where) for dim, where in self.shown.items()]
        held = [words.setting(runs[dim], [at]) for dim, at in self.held.items()]
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

    along: design dimensions on an axis of the figure. panel: the dimension that gets a panel a
    value. prefer: dimensions that get curves first. most: the largest number of curves.
    """
    dims = [dim for dim in design_dims(runs, runs[variable].dims) if dim not in along]
    panels = _panels(runs, panel) if panel in dims else [Choice({}, "")]
    left = sorted((dim for dim in dims if dim != panel), key=lambda dim: _rank(dim, prefer))
    shown = _shown({dim: runs.sizes[dim] for dim in left if runs.sizes[dim] > 1}, most)
    held = {d: _held(runs[d]) for d in left if d not in shown and runs.sizes[d] > 1}
    single = {dim: 0 for dim in left if runs.sizes[dim] == 1}
    return Plan(panels, _curves(runs, shown, single), shown, held)


def _shown(sizes: dict[str, int], most: int) -> dict[str, list[int]]:
    """Positions on at most two dimensions; the first leaves room for two of the second."""
    shown: dict[str, list[int]] = {}
    room = min(most, max(most // 2, 2)) if len(sizes) > 1 else most
    for dim, size in list(sizes.items())[:2]:
        if min(size, room) > 1:
            shown[dim] = spread(size, min(size, room))
        room = most // len(shown.get(dim, [0]))
    return shown


def spread(size: int, count: int) -> list[int]:
    """`count` positions of `size`, evenly spread, the first and the last among them."""
    return [int(at) for at in np.unique(np.linspace(0, size - 1, count).round())]


def _panels(runs: xr.Dataset, dim: str | None) -> list[Choice]:
    where = spread(runs.sizes[dim], min(runs.sizes[dim], MOST_PANELS))
    return [Choice({str(dim): at}, words.value(runs[dim], at)) for at in where]


def _curves(runs: xr.Dataset, shown: dict[str, list[int]], single: dict[str, int]) -> list[Choice]:
    chosen = []
    for ordinals in product(*(range(len(where)) for where in shown.values())):
        where = {dim: shown[dim][i] for dim, i in zip(shown, ordinals, strict=True)}
        label = ", ".join(words.value(runs[dim], at) for dim, at in where.items())
        place = (*ordinals, *ordinals[:1], 0, 0) if len(ordinals) < 2 else ordinals
        chosen.append(Choice(where | single, label, (place[0], place[1])))
    return chosen


def _rank(dim: str, prefer: Sequence[str]) -> int:
    return prefer.index(dim) if dim in prefer else len(prefer)


def _held(coordinate: xr.DataArray) -> int:
    """The finest numerics; the middle of other numbers; the first of names."""
    if coordinate.name in _SMALL:
        return int(np.argmin(coordinate.values))
    if coordinate.name in _LARGE:
        return int(np.argmax(coordinate.values))
    return coordinate.size // 2 if coordinate.dtype.kind in "if" else 0
