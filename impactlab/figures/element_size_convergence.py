"""Convergence of the responses as the solid elements get smaller."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, labels, refinement, style
from impactlab.figures.labels import display
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS

TITLE = "Convergence in the size of the solid elements"


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the grid has at least three sizes of solid elements."""
    return _axis(runs).applies(runs) and SOLID in runs["beam_model"].values


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    chosen, axis = _solid(runs), _axis(runs)
    return (
        "Three-dimensional model alone; elements beyond the contact keep their largest size. "
        f"{refinement.CAPTION} {axis.plan(chosen).note(chosen)} "
        f"{access.missing_note(runs, axis.names(chosen))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    axis = _axis(runs)
    values = runs[axis.dim].values
    if axis.dim == "element_size":
        unit = display(runs[axis.dim])
        sizes, label = unit(values), labels.axis("element size", unit.symbol)
    else:
        sizes = np.round(100.0 / values, 1)
        label = labels.axis("element size over expected contact radius", "%")
    return refinement.draw(_solid(runs), _solid(analysis), axis, sizes, label)


def _axis(runs: xr.Dataset) -> refinement.Refined:
    dim = next((name for name in ELEMENTS if name in runs.dims), ELEMENTS[0])
    return refinement.Refined("element_size", dim, ("velocity", "beam_yield_stress"))


def _solid(dataset: xr.Dataset) -> xr.Dataset:
    """The runs of the 3-D model, to which the nodes are nothing."""
    if "beam_model" in dataset.dims:
        dataset = dataset.sel(beam_model=SOLID)
    return dataset.isel(nodes=0) if "nodes" in dataset.dims else dataset
