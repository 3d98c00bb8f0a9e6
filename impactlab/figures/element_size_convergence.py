"""Convergence of the responses as the solid elements get smaller."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import refinement, style
from impactlab.figures.reading import missing, words
from impactlab.figures.reading.units import display
from impactlab.model.impact import SOLID

TITLE = "Convergence in the size of the solid elements"
_AXIS = refinement.Refined("element_size", "element_size", ("velocity", "beam_yield_stress"))


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the grid has at least three sizes of solid elements."""
    return _AXIS.applies(runs) and SOLID in runs["beam_model"].values


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    chosen = _solid(runs)
    return (
        "Three-dimensional model alone; elements beyond the contact keep their largest size. "
        f"{refinement.CAPTION} {_AXIS.plan(chosen).note(chosen)} "
        f"{missing.note(runs, _AXIS.names(chosen))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    unit = display(runs["element_size"])
    label = words.axis("element size", unit.symbol)
    sizes = unit(runs["element_size"].values)
    return refinement.draw(_solid(runs), _solid(analysis), _AXIS, sizes, label)


def _solid(dataset: xr.Dataset) -> xr.Dataset:
    """The runs of the 3-D model, to which the nodes are nothing."""
    if "beam_model" in dataset.dims:
        dataset = dataset.sel(beam_model=SOLID)
    return dataset.isel(nodes=0) if "nodes" in dataset.dims else dataset
