"""Panels of errors against one axis of the discretisation that is refined."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from impactlab.figures import curves, responses_grid, scales, style
from impactlab.figures.access import known, responses, usable
from impactlab.figures.curves import Choice, Plan, plan

FEWEST = 3
CAPTION = (
    "Difference to the limit, relative to it: Richardson's value, or where there is none that of "
    "the least-squares fit, or else the finest value. Thin dashes: the order p of that limit (in "
    "brackets where it is assumed, not observed). The bar at the finest value reaches up to its "
    "numerical uncertainty. Grey: second order. A verdict is the worst over the whole grid, also "
    "over what is not drawn."
)
_DASHED: dict[str, Any] = {"linestyle": (0, (2, 1.5)), "linewidth": 0.6}
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Refined:
    """An axis of refinement. name: prefix of the analysis's variables; dim: of the runs.

    prefer: dimensions that get curves first; most: the largest number of curves.
    """

    name: str
    dim: str
    prefer: tuple[str, ...]
    most: int = 4

    def names(self, runs: xr.Dataset) -> list[str]:
        """Return the responses that vary on it."""
        return [name for name in responses(runs) if self.dim in runs[name].dims]

    def plan(self, runs: xr.Dataset) -> Plan:
        """Return the plan of the curves."""
        first = self.names(runs)[0]
        return plan(runs, first, along=[self.dim], prefer=self.prefer, most=self.most)

    def applies(self, runs: xr.Dataset) -> bool:
        """Return whether the grid has at least three values on it."""
        return runs.sizes.get(self.dim, 0) >= FEWEST and bool(self.names(runs))


@dataclass(frozen=True)
class Trend:
    """An error that follows scale h^order; uncertainty: of the finest value; observed: the order.

    NaN where there is none.
    """

    order: float
    uncertainty: float
    observed: bool


def draw(
    runs: xr.Dataset, analysis: xr.Dataset, axis: Refined, spacing: Array, label: str
) -> Figure:
    """Draw a panel per response, a curve for each of a few other settings.

    spacing: of each value on the axis, in the unit of the label, in the order of the runs.
    """
    selected = axis.plan(runs)
    figure, axes = responses_grid.panels(axis.names(runs), height=44)
    for name, ax in axes.items():
        responses_grid.write_verdict(ax, analysis, f"{axis.name}_summary", name)
        difference = relative_difference(runs, analysis, axis, name)
        orders = []
        for curve, errors in drawn(difference, selected):
            (line,) = ax.plot(spacing, errors, label=curve.label or "_only", **curves.marked(curve))
            trend = _trend(analysis, axis, name, selected.held | curve.where)
            _draw_trend(ax, spacing, errors, trend, line)
            orders.append((line, trend))
        _write_orders(ax, orders)
        _finish(ax, spacing, difference, axis.dim)
    figure.supxlabel(label)
    figure.supylabel("Relative difference (–)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def drawn(difference: xr.DataArray, selected: Plan) -> Iterator[tuple[Choice, Array]]:
    """Yield each curve that has an error above round-off, with its errors along the axis."""
    for curve in selected.curves:
        errors = scales.positive(
            difference.isel(selected.held | curve.where), above=responses_grid.ROUND_OFF
        )
        if np.isfinite(errors).any():
            yield curve, errors


def relative_difference(
    runs: xr.Dataset, analysis: xr.Dataset, axis: Refined, name: str
) -> xr.DataArray:
    """Return |f - f0|/|f0| on (axis, ...), NaN where f0 is 0.

    f0: the limit, or else the finest value.
    """
    values = usable(runs, name)
    reference = values.isel({axis.dim: finest(runs, axis.dim)}, drop=True)
    for kind in ("fit_extrapolated", "extrapolated"):
        limit = _of(analysis, f"{axis.name}_{kind}", name)
        reference = reference if limit is None else limit.where(np.isfinite(limit), reference)
    ratio = abs(values - reference) / abs(reference).where(reference != 0)
    return ratio.where((values != 0) | (reference != 0), 0.0).transpose(axis.dim, ...)


def finest(runs: xr.Dataset, dim: str) -> int:
    """Return the position of the finest value: most nodes, smallest courant or element size."""
    values = runs[dim].values
    return int(np.argmin(values) if dim in ("courant", "element_size") else np.argmax(values))


def _of(analysis: xr.Dataset, variable: str, name: str) -> xr.DataArray | None:
    if variable not in analysis or not known(analysis, name):
        return None
    return analysis[variable].sel(response=name, drop=True)


def _trend(analysis: xr.Dataset, axis: Refined, name: str, where: dict[str, int]) -> Trend:
    """Return the trend of one curve by the analysis."""

    def read(key: str) -> float:
        found = _of(analysis, f"{axis.name}_{key}", name)
        return float("nan") if found is None else float(found.isel(where))

    if np.isfinite(read("extrapolated")):
        return Trend(read("observed_order"), read("uncertainty"), True)
    return Trend(read("fit_order"), read("uncertainty"), read("fit_expansion") == 0)


def _draw_trend(ax: Axes, spacing: Array, errors: Array, trend: Trend, line: Line2D) -> None:
    """Draw the order through the errors of the three finest values, and the bar of the finest."""
    near, colour = np.argsort(spacing)[:FEWEST], line.get_color()
    scale = np.log(errors[near]) - trend.order * np.log(spacing[near])
    if np.isfinite(scale).any():
        ends = np.array([spacing.min(), spacing.max()])
        power = np.exp(np.nanmedian(scale)) * ends**trend.order
        ax.plot(ends, power, color=colour, label="_order", **_DASHED)
    if np.isfinite(trend.uncertainty) and trend.uncertainty > responses_grid.ROUND_OFF:
        at, low = spacing[near[0]], errors[near[0]]
        bar = [low if np.isfinite(low) else trend.uncertainty, trend.uncertainty]
        ax.plot([at, at], bar, color=colour, linewidth=0.8, label="_bar")
        ax.plot(at, trend.uncertainty, color=colour, marker="_", markersize=6, label="_bar")


def _write_orders(ax: Axes, orders: list[tuple[Line2D, Trend]]) -> None:
    """Write the order of each curve beside its marker, to the right of the panel."""
    known_orders = [(line, trend) for line, trend in orders if np.isfinite(trend.order)]
    if known_orders:
        ax.legend(
            [line for line, _ in known_orders],
            [
                f"p = {trend.order:.2f}" if trend.observed else f"[p = {trend.order:g}]"
                for _, trend in known_orders
            ],
            loc="lower left",
            bbox_to_anchor=(1.0, 0.0),
            borderaxespad=0.0,
            fontsize=6,
            handlelength=1.0,
            handletextpad=0.4,
            labelspacing=0.2,
            borderpad=0.1,
        )


def _finish(ax: Axes, spacing: Array, difference: xr.DataArray, dim: str) -> None:
    """Make the axes logarithmic, and draw a guide of second order above the curves."""
    if not ax.lines:
        enough = bool((difference.count(dim) > 1).any())
        responses_grid.empty(ax, "same on every grid" if enough else "too few values")
        return
    shown = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    ends = np.array([spacing.min(), spacing.max()])
    guide = 1.6 * np.nanmax(shown) * (ends / ends[1]) ** 2
    ax.plot(ends, guide, label="_guide", linestyle="-", **style.GUIDE)
    scales.logarithmic(ax, "x", spacing)
    scales.logarithmic(ax, "y", [*shown, *guide])
    if spacing.size <= 5:
        scales.at(ax, "x", scales.apart(spacing))
    ax.set_xlim(0.85 * ends[0], 1.18 * ends[1])
