"""The figure of convergence in the size of the solid elements."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from impactlab.fem3d.wing import MODEL, SIZES, SOLID
from impactlab.figures import labels, record
from impactlab.figures.convergence import CAPTION, Refined, draw, enough
from impactlab.figures.labels import display


def _elements(runs: xr.Dataset) -> Refined:
    dim = next((name for name in SIZES if name in runs.dims), SIZES[0])
    return Refined(MODEL.axis, dim, ("velocity", "beam_yield_stress"))


def _solid(dataset: xr.Dataset) -> xr.Dataset:
    """Return the runs of the 3-D model, which do not depend on the nodes."""
    if "beam_model" in dataset.dims:
        dataset = dataset.sel(beam_model=SOLID)
    return dataset.isel(nodes=0) if "nodes" in dataset.dims else dataset


@record.figure(
    MODEL.axis_title,
    "Three-dimensional model alone; elements beyond the contact keep their largest size. "
    f"{CAPTION}",
    lambda runs, analysis: (
        _elements(runs).applies(runs, analysis) and SOLID in runs["beam_model"].values
    ),
    lambda runs, analysis: (
        enough(runs, analysis),
        *_elements(runs).sentences(_solid(runs), _solid(analysis))[1:],
    ),
)
def element_size_convergence(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw against the size of the elements, or over the radius that the contact is to have."""
    axis = _elements(runs)
    values = runs[axis.dim].values
    if axis.dim == "element_size":
        unit = display(runs[axis.dim])
        sizes, label = unit(values), labels.axis("element size", unit.symbol)
    else:
        sizes = np.round(100.0 / values, 1)
        label = labels.axis("element size over expected contact radius", "%")
    return draw(_solid(runs), _solid(analysis), axis, sizes, label)
