"""Convergence of the responses as the nodes get closer."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, labels, refinement, style
from impactlab.figures.labels import display

TITLE = "Convergence in nodes"
_AXIS = refinement.Refined("nodes", "nodes", ("velocity", "points"))


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the grid has at least three numbers of nodes."""
    return _AXIS.applies(runs)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        f"{refinement.CAPTION} {_AXIS.plan(runs).note(runs)} "
        f"{access.missing_note(runs, _AXIS.names(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    return refinement.draw(runs, analysis, _AXIS, *_spacing(runs))


def _spacing(runs: xr.Dataset) -> tuple[refinement.Array, str]:
    """The spacing of the nodes with its label; over the span where the span is varied."""
    relative = 1.0 / (runs["nodes"].values - 1.0)
    if runs["beam_span"].ndim:
        return relative, "Spacing of the nodes over the span (–)"
    spacing = (runs["beam_span"] * xr.DataArray(relative)).assign_attrs(units="m").rename("spacing")
    unit = display(spacing)
    return unit(spacing), labels.axis("spacing of the nodes", unit.symbol)
