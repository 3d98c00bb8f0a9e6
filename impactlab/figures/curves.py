"""Curves of chosen runs, and of which runs of a large grid; measurements over them."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.analysis.measurements import COVERAGE, Agreement
from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import design_dims, usable
from impactlab.figures.labels import Display
from impactlab.model.parameters import REFINEMENTS
from impactlab.types import Floats
from impactlab.variables import of_function

_JUMP, _FEW_STEPS = 5.0, 4
_STEP, _TURNS = 0.1, 3  # least step of a zigzag over the range of the curve, and number of turns
_SAME = 0.01  # largest difference, over the range and the values, that is too small to see
_MOST = 6  # largest number of panels, and of curves if no other is asked for

_MEASURED: dict[str, Any] = {
    "color": "black",
    "linestyle": "",
    "marker": "D",
    "markersize": 3.0,
    "markerfacecolor": "white",
    "elinewidth": 0.8,
    "capsize": 2.0,
    "zorder": 5.0,
}
_WORDS = {False: "measured", True: "another model"}  # by whether the values are simulated


@dataclass(frozen=True)
class Selection:
    """Positions on design dimensions (for `isel`), their label, and ordinals of colour and line."""

    where: dict[str, int]
    label: str
    place: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Plan:
    """The panels and curves of a figure.

    shown: positions by dimension. held: dimensions fixed at one position. meanings: of the
    dimensions shown.
    """

    panels: list[Selection]
    curves: list[Selection]
    shown: dict[str, list[int]]
    held: dict[str, int]
    meanings: list[str]

    def finish(self, figure: Figure, x: str = "", y: str = "") -> Figure:
        """Add the legend, headed by the parameters in which curves differ; x, y: for all panels."""
        title = labels.sentence(", ".join(self.meanings))
        order = [*(curve.label for curve in self.curves), *_WORDS.values()]
        return style.finish(figure, x, y, title=title, order=order)

    def note(self, runs: xr.Dataset) -> str:
        """Return a caption's sentences on the values that are shown and held."""
        shown = [labels.setting(runs[dim], where) for dim, where in self.shown.items()]
        held = [labels.setting(runs[dim], [position]) for dim, position in self.held.items()]
        text = f"Curves: {'; '.join(shown)}." if shown else ""
        return f"{text} Held: {'; '.join(held)}.".strip() if held else text


def plan(
    runs: xr.Dataset,
    variable: str,
    *,
    along: Sequence[str] = (),
    panel: str | None = None,
    prefer: Sequence[str] = ("velocity",),
    most: int = _MOST,
) -> Plan:
    """Choose what to show of a variable of the runs.

    along: design dimensions on an axis of the figure. panel: the dimension that gets a panel
    per value. prefer: dimensions that get curves first. most: the largest number of curves.
    """
    dims = [dim for dim in design_dims(runs, runs[variable].dims) if dim not in along]
    panels = [Selection({}, "")]
    if panel is not None and panel in dims:
        places = scales.spread(runs.sizes[panel], _MOST)
        panels = [Selection({panel: place}, labels.value(runs[panel], place)) for place in places]
    rank = {dim: position for position, dim in enumerate(prefer)}
    left = sorted((dim for dim in dims if dim != panel), key=lambda dim: rank.get(dim, len(rank)))
    # beside a wing's runs, as no model there is refined by what refines the other
    finest = REFINEMENTS.keys() - {*prefer} if access.further_models(runs) else set()
    several = [dim for dim in left if runs.sizes[dim] > 1 and dim not in finest]
    shown: dict[str, list[int]] = {}
    # the first of at most two dimensions leaves room for two values of the second
    room = min(most, max(most // 2, 2)) if len(several) > 1 else most
    for dim in several[:2]:
        if room > 1:
            shown[dim] = scales.spread(runs.sizes[dim], room)
        room = most // len(shown.get(dim, [0]))
    held = {d: _held(runs[d]) for d in left if d not in shown and runs.sizes[d] > 1}
    single = {dim: 0 for dim in left if runs.sizes[dim] == 1}
    curves = []
    for ordinals in product(*(range(len(where)) for where in shown.values())):
        where = {dim: shown[dim][i] for dim, i in zip(shown, ordinals, strict=True)}
        label = ", ".join(labels.value(runs[dim], position) for dim, position in where.items())
        colour, line = (*ordinals, *ordinals, 0, 0)[:2]
        curves.append(Selection(held | where | single, label, (colour, line)))
    return Plan(panels, curves, shown, held, [labels.parameter(runs[dim]) for dim in shown])


def _held(coordinate: xr.DataArray) -> int:
    """Return the position of the finest numerics, the middle number, or the first name."""
    refinement = REFINEMENTS.get(str(coordinate.name))
    if refinement and not of_function(coordinate):
        return int(refinement.finest_first(coordinate.values)[0])
    return coordinate.size // 2 if coordinate.dtype.kind in "if" else 0


def look(curve: Selection, *, markers: bool = False) -> dict[str, Any]:
    """Return the colour by the first shown dimension, the line style by the second (or the first).

    Later curves lie below, as they are the larger ones where the values rise. Markers are for few
    points.
    """
    colour, line = curve.place
    line_style = line + colour // len(style.COLOURS)  # one further each time round
    return {
        "color": style.COLOURS[colour % len(style.COLOURS)],
        "linestyle": style.LINES[line_style % len(style.LINES)],
        "zorder": 3.0 - 0.01 * colour - 0.001 * line,
        "marker": style.MARKERS[line_style % len(style.MARKERS)] if markers else "",
    }


def add(
    ax: Axes, x: Floats, y: Floats, curve: Selection, *, markers: bool = True, covered: int = 0
) -> bool:
    """Draw a curve that has finite points; return whether it has.

    covered: number of curves on top of it: its markers are rings around theirs.
    """
    finite = bool(np.isfinite(x + y).any())
    if finite:
        shape = look(curve, markers=markers)
        if covered:
            size = rcParams["lines.markersize"] + 2.6 * covered
            shape |= {"markersize": size, "markerfacecolor": "none", "markeredgewidth": 0.8}
            shape["clip_on"] = False  # the axes leave room for markers of the usual size
        ax.plot(x, y, label=curve.label or "_only", **shape)
    return finite


def coincide(y: Floats, other: Floats) -> bool:
    """Return whether two curves lie on each other in half of their points or more."""
    both = np.isfinite(y) & np.isfinite(other)
    if not both.any():
        return False
    pair = np.array([y[both], other[both]])
    visible = _SAME * np.minimum(np.ptp(pair), np.abs(pair).max(axis=0))
    return bool(np.mean(np.abs(pair[0] - pair[1]) <= visible) >= 0.5)


def broken(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return a curve with a gap, of NaN, in each jump: a step of another size than those beside it.

    A step jumps if it is a tenth of the range or more, and _JUMP times as large and as steep as
    both steps beside it. A curve that turns _TURNS times, each time by a tenth of the range or
    more, is a zigzag and has gaps everywhere: its points tell nothing of what lies between them.
    """
    if _is_zigzag(y):
        gaps = np.arange(1, y.size)
        return np.insert(x.astype(float), gaps, np.nan), np.insert(y.astype(float), gaps, np.nan)
    rise, run = np.abs(np.diff(y)), np.abs(np.diff(x))
    if rise.size < _FEW_STEPS or not np.isfinite(y).all() or not (run > 0).all():
        return x, y
    slope = rise / run
    beside = [
        np.maximum(np.append(0.0, changes[:-1]), np.append(changes[1:], 0.0))
        for changes in (rise, slope)
    ]
    jumps = (rise > 0.1 * np.ptp(y)) & (rise > _JUMP * beside[0]) & (slope > _JUMP * beside[1])
    gaps = np.flatnonzero(jumps) + 1
    return np.insert(x.astype(float), gaps, np.nan), np.insert(y.astype(float), gaps, np.nan)


def _is_zigzag(y: Floats) -> bool:
    finite = y[np.isfinite(y)]
    steps = np.diff(finite)
    large = steps[np.abs(steps) >= _STEP * np.ptp(finite)] if steps.size else steps
    return int((large[1:] * large[:-1] < 0).sum()) >= _TURNS


def chosen(runs: xr.Dataset, variable: str) -> Plan:
    """Plan a panel per contact law, a curve for each of some velocities (or what else is varied).

    Where nothing else is varied, the laws are the curves.
    """
    dims = [dim for dim in design_dims(runs, runs[variable].dims) if dim != "contact"]
    alone = all(runs.sizes[dim] == 1 for dim in dims)
    return plan(runs, variable, panel=None if alone else "contact")


def draw(
    runs: xr.Dataset,
    variable: str,
    line: Callable[[xr.Dataset], tuple[Floats, Floats]],
    x: str,
    y: str,
    *,
    markers: bool = False,
) -> tuple[Figure, list[Axes], Plan]:
    """Draw each chosen run that has finite values, still without a legend; the others leave a gap.

    variable: runs without finite values of it have no curve. line: the x and y of a curve, from the
    dataset of its run. x, y: labels of the axes, x below each column, y at the left of each row.
    """
    selected = chosen(runs, variable)
    valid = runs.assign({variable: usable(runs, variable)})
    columns = min(len(selected.panels), 3)
    titles = [labels.sentence(panel.label) for panel in selected.panels]
    figure, axes = style.titled_panels(titles, columns=columns, height=62, sharex=True, sharey=True)
    for ax, panel in zip(axes, selected.panels, strict=True):
        for curve in selected.curves:
            run = valid.isel(panel.where | curve.where)
            if np.isfinite(run[variable]).any():
                ax.plot(*line(run), label=curve.label or "_only", **look(curve, markers=markers))
        if not ax.lines:
            style.remark(ax)
        ax.label_outer(remove_inner_ticks=False)
        ax.set(xlabel=x, ylabel=y if style.starts_row(ax) else None)
    return figure, axes, selected


def note(runs: xr.Dataset, variable: str) -> str:
    """Return a caption's sentences on the curves, what is held, and chosen runs without a curve."""
    selected = chosen(runs, variable)
    absent = access.absent(runs, variable)
    gaps = [
        ", ".join(filter(None, (curve.label, panel.label)))
        for panel in selected.panels
        for curve in selected.curves
        if bool(absent.isel(panel.where | curve.where))
    ]
    without = f" No curve for {labels.listing(gaps)}." if gaps else ""
    return f"{selected.note(runs)}{without}".strip()


def measurements(analysis: xr.Dataset, name: str, along: str) -> xr.Dataset:
    """Return the measurements of a response that state `along`, in its order, each of them once.

    Measurements of another impact than the study's are left out.
    """
    if "compared_quantity" not in analysis:
        return xr.Dataset(coords={"comparison": []})
    quantity, verdict = (analysis[f"compared_{key}"] for key in ("quantity", "verdict"))
    stating = (quantity == name) & (verdict != Agreement.OTHER_IMPACT)
    compared = analysis[[key for key in analysis if str(key).startswith("compared_")]]
    compared = compared.isel(comparison=np.flatnonzero(stating.values))
    keys = ("conditions", "measured", "uncertainty", "source")
    columns = (compared[f"compared_{key}"].values.tolist() for key in keys)
    positions: dict[tuple[Any, ...], int] = {}  # by place along the parameter, value and source
    for position, (text, *rest) in enumerate(zip(*columns, strict=True)):
        place = json.loads(text).get(along)
        if isinstance(place, int | float):
            positions.setdefault((place, *rest), position)
    ordered = sorted(positions, key=lambda key: float(key[0]))
    once = compared.isel(comparison=[positions[key] for key in ordered])
    return once.assign_coords(along=("comparison", [key[0] for key in ordered]))


def add_measured(
    ax: Axes, analysis: xr.Dataset, name: str, along: str, x: Display, y: Display
) -> None:
    """Draw the measurements of a response over the parameter `along`, with expanded uncertainty."""
    points = measurements(analysis, name, along)
    for simulated, label in _WORDS.items():
        if not points.sizes["comparison"]:
            return
        group = points.isel(comparison=points["compared_simulated"].values == simulated)
        if group.sizes["comparison"]:
            value, bar = (group[f"compared_{key}"].values for key in ("measured", "uncertainty"))
            ax.errorbar(x(group["along"].values), y(value), y(bar), label=label, **_MEASURED)


def note_measured(analysis: xr.Dataset, names: list[str], along: str) -> str:
    """Return a caption's sentence on the measurements drawn; "" without any."""
    points = [measurements(analysis, name, along) for name in names]
    drawn = [dataset["compared_source"].values for dataset in points if dataset.comparison.size]
    if not drawn:
        return ""
    listed = "; ".join(dict.fromkeys(map(str, np.concatenate(drawn))))
    return f"Diamonds with expanded uncertainties (k = {COVERAGE:g}): {listed}."
