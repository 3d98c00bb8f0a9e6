"""How the responses of a grid change with its parameters."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, physical, responses
from impactlab.figures.curves import Plan, plan
from impactlab.figures.labels import display

TITLE = "Effect of the varied parameters"
_FEWEST = 3


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether a physical parameter of a grid has at least three values."""
    return not is_sample(runs) and _along(runs) is not None and bool(responses(runs))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        f"Responses against the {labels.parameter(str(_along(runs)))}; where curves coincide, the "
        f"first in the legend lies on top. {_plan(runs).note(runs)} "
        f"{access.missing_note(runs, responses(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response: colours by the second parameter, line styles by the third."""
    along, selected = runs[_along(runs)], _plan(runs)
    unit = display(along)
    figure, axes = responses_grid.panels(responses(runs), height=38)
    for name, ax in axes.items():
        values, label = responses_grid.shown(runs, name)
        ax.set_title(label, loc="left")
        for curve in selected.curves:
            y = values.isel(selected.held | curve.where).values
            if np.isfinite(y).any():
                look = curves.marked(curve)
                ax.plot(unit(along), y, label=curve.label or "_only", **look)
        drawn = [value for line in ax.lines for value in np.asarray(line.get_ydata())]
        scales.fit(ax, "x", unit(along))
        scales.fit(ax, "y", drawn)
        if not ax.lines:
            responses_grid.empty(ax, "no finite values")
    figure.supxlabel(labels.axis(labels.parameter(str(along.name)), unit.symbol))
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _along(runs: xr.Dataset) -> str | None:
    """The first physical parameter with enough values to draw a curve."""
    found = (name for name in physical(runs) if runs.sizes.get(name, 0) >= _FEWEST)
    return next(found, None)


def _plan(runs: xr.Dataset) -> Plan:
    others = [name for name in physical(runs) if name != _along(runs)]
    return plan(runs, responses(runs)[0], along=[str(_along(runs))], prefer=others)
