"""Sobol indices of second order, as a map of pairs."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from impactlab.figures import access, labels, responses_grid, style
from impactlab.figures.index_bars import undefined
from impactlab.figures.measures import asked, parameters

TITLE = "Sobol indices of second order"
_INDEX = "second_order"
_FEWEST = 2
_WEAK = 10.0
"""Per cent: the scale of colours never ends below."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the analysis has second-order indices of at least two parameters."""
    return (
        _INDEX in analysis
        and analysis.sizes["parameter"] >= _FEWEST
        and bool(asked(runs, analysis))
    )


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown and what is missing."""
    return (
        "Share of the variance, in %, that two parameters bring together; columns are "
        f"numbered as the rows. Grey: zero lies within the {access.confidence(analysis)} "
        "interval. "
        f"{access.missing_note(runs, asked(runs, analysis))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a cell a pair, all in one scale of colours."""
    shown = asked(runs, analysis)
    listed = parameters(analysis)
    figure, axes = responses_grid.panels(shown, 12 + 4.6 * len(listed), beneath=14)
    values = {name: 100 * pairs(analysis[_INDEX].sel(response=name)) for name in shown}
    margin = {name: 100 * _margins(analysis, name) for name in shown}
    colours = Normalize(0.0, max([_top(values[n], margin[n]) for n in shown], default=_WEAK))
    for at, (name, ax) in enumerate(axes.items()):
        image = _map(ax, values[name], np.abs(values[name]) > margin[name], colours)
        undefined(ax, analysis, name, _INDEX)
        _label(ax, listed, named=at % responses_grid.COLUMNS == 0)
    thin = 20 * min(len(shown), 2)
    bar = figure.colorbar(
        image, ax=list(axes.values()), location="bottom", fraction=0.05, aspect=thin, shrink=0.6
    )
    bar.set_label("Share of the variance (%)")
    return figure


def pairs(index: xr.DataArray) -> NDArray[np.float64]:
    """Each pair once, above the diagonal; NaN elsewhere. index: on (parameter, other_parameter)."""
    square = index.transpose("parameter", "other_parameter").values
    both = np.where(np.isfinite(square), square, square.T)
    return np.where(np.triu(np.ones_like(both, dtype=bool), 1), both, np.nan)


def _margins(analysis: xr.Dataset, name: str) -> NDArray[np.float64]:
    """Half-widths of the intervals; infinite where not given, for then nothing is known."""
    interval = analysis.get(f"{_INDEX}_interval")
    if interval is None:
        return np.full((analysis.sizes["parameter"],) * 2, np.inf)
    found = pairs(interval.sel(response=name))
    return np.where(np.isfinite(found), found, np.inf)


def _top(values: NDArray[np.float64], margin: NDArray[np.float64]) -> float:
    """The largest significant index, at least _WEAK, so that noise does not get strong colours."""
    return float(np.max(values, initial=_WEAK, where=np.abs(values) > margin))


def _map(
    ax: Axes, values: NDArray[np.float64], significant: NDArray[np.bool_], colours: Normalize
) -> AxesImage:
    shown = np.where(significant, values, np.nan)
    ax.imshow(np.where(np.isfinite(values), 0.93, np.nan), cmap="gray", vmin=0, vmax=1)
    image = ax.imshow(shown, cmap="Blues", norm=colours, interpolation="nearest")
    for row, column in np.argwhere(np.isfinite(values)):
        value = values[row, column]
        dark = bool(significant[row, column]) and colours(value) > 0.55
        colour = "white" if dark else "black" if significant[row, column] else "0.5"
        ax.text(column, row, _short(value), ha="center", va="center", fontsize=6, color=colour)
    return image


def _short(value: float) -> str:
    """Whole per cent, for a cell has room for two digits."""
    text = f"{value:.0f}".replace("-", "−")
    return "0" if text == "−0" else text


def _label(ax: Axes, listed: list[str], *, named: bool) -> None:
    count = len(listed)
    numbers = [str(at) for at in range(1, count + 1)]
    rows = [f"{labels.parameter(name)} {at}" for name, at in zip(listed, numbers, strict=True)]
    ax.set_yticks(range(count), rows if named else numbers)
    ax.set_xticks(range(count), numbers)
    ax.set(xlim=(-0.5, count - 0.5), ylim=(count - 0.5, -0.5), aspect="auto")
    ax.tick_params(length=0)
    ax.grid(visible=False)
    for spine in ax.spines.values():
        spine.set_visible(False)
