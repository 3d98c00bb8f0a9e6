"""Figures of second-order Sobol indices, and of the elementary effects of Morris.

Morris (1991), Technometrics 33, 161; µ* after Campolongo et al. (2007), Environ. Modell. Softw. 22.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure as MplFigure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from impactlab.figures import access, labels, measures, responses_grid, scales, style
from impactlab.figures.indices import undefined
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, analysed, parameters
from impactlab.figures.record import Figure

_INDEX = "second_order"
_FEWEST = 2
_WEAK = 10.0
"""Smallest upper end of the colour scale, in %."""
_SLOPES = ((1.0, "σ = µ*"), (0.1, "σ = 0.1 µ*"))


def _second_order_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has second-order indices of at least two parameters."""
    return (
        _INDEX in analysis
        and analysis.sizes["parameter"] >= _FEWEST
        and bool(analysed(runs, analysis))
    )


def _second_order_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Share of the variance, in %, that two parameters bring together; columns are "
        f"numbered as the rows. Grey: zero lies within the {access.confidence(analysis)} "
        "interval. "
        f"{access.missing_note(runs, analysed(runs, analysis))}".strip()
    )


@style.paper
def _plot_second_order(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a cell per pair, all on one colour scale."""
    shown = analysed(runs, analysis)
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
    """Return each pair once, above the diagonal; NaN elsewhere.

    index: on (parameter, other_parameter).
    """
    square = index.transpose("parameter", "other_parameter").values
    both = np.where(np.isfinite(square), square, square.T)
    return np.where(np.triu(np.ones_like(both, dtype=bool), 1), both, np.nan)


def _margins(analysis: xr.Dataset, name: str) -> NDArray[np.float64]:
    """Return the half-widths of the intervals, infinite where none is given."""
    interval = analysis.get(f"{_INDEX}_interval")
    if interval is None:
        return np.full((analysis.sizes["parameter"],) * 2, np.inf)
    found = pairs(interval.sel(response=name))
    return np.where(np.isfinite(found), found, np.inf)


def _top(values: NDArray[np.float64], margin: NDArray[np.float64]) -> float:
    """Return the largest significant index, but at least _WEAK, to keep noise pale."""
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
    """Return whole per cent, as a cell has room for two digits."""
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


SECOND_ORDER = Figure(
    "sobol_second_order",
    "Sobol indices of second order",
    _second_order_applies,
    _plot_second_order,
    _second_order_caption,
)


def _morris_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has the mean magnitudes and the spread of elementary effects."""
    return (
        "morris_mu_star" in analysis
        and "morris_sigma" in analysis
        and bool(analysed(runs, analysis))
    )


def _morris_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        f"{MORRIS.meaning} Above σ = µ* an effect changes its size or sign with the others or "
        "along the range; below σ = 0.1 µ* it is nearly linear and additive. Lines: "
        f"{access.confidence(analysis)} intervals of µ*. "
        f"{access.missing_note(runs, analysed(runs, analysis))}".strip()
    )


@style.paper
def _plot_morris(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a marker per parameter."""
    figure, axes = responses_grid.panels(analysed(runs, analysis), height=48)
    for name, ax in axes.items():
        _plane(ax, runs, analysis, name)
    style.legend(figure)
    return figure


def _plane(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, response: str) -> None:
    strength = measures.index(analysis, "morris_mu_star", response)
    spread = analysis["morris_sigma"].sel(response=response).values
    effects = xr.DataArray(strength.values, attrs=runs[response].attrs, name=response)
    unit = display(effects)
    x, y, margin = unit(strength.values), unit(spread), unit(strength.margins)
    for at, name in enumerate(measures.parameters(analysis)):
        if np.isfinite(x[at]):
            ax.errorbar(
                x[at],
                y[at],
                xerr=margin[at] if np.isfinite(margin[at]) else None,
                label=labels.parameter(name),
                elinewidth=0.8,
                **(style.distinct(at) | {"linestyle": ""}),
            )
    responses_grid.warn(ax, analysis, "sensitivity_verdict", response)
    if not ax.lines:
        responses_grid.empty(ax, "no finite values")
        return
    ax.set(xlabel=labels.axis("mean µ*", unit.symbol), ylabel=labels.axis("spread σ", unit.symbol))
    _guides(ax, right=float(np.nanmax(x + np.nan_to_num(margin, posinf=0.0))), top=np.nanmax(y))


def _guides(ax: Axes, right: float, top: float) -> None:
    ax.set(xlim=(0.0, 1.1 * right or 1.0), ylim=(0.0, 1.15 * max(top, 0.12 * right) or 1.0))
    for slope, text in _SLOPES:
        ax.axline((0.0, 0.0), slope=slope, label="_guide", **style.GUIDE)
        x = min(0.97 * ax.get_xlim()[1], 0.9 * ax.get_ylim()[1] / slope)
        ax.text(x, slope * x, text, fontsize=6, color=style.MUTED, ha="right", va="bottom")
    scales.linear(ax, "x")
    scales.linear(ax, "y")


MORRIS_PLANE = Figure(
    "morris_plane",
    MORRIS.title,
    _morris_applies,
    _plot_morris,
    _morris_caption,
)
