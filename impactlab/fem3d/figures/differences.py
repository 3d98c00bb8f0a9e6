"""The beam models beside their 3-D witness: each on its finest grid, with its uncertainty."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.figures.access import known, responses, usable
from impactlab.model.impact import SOLID

Array = NDArray[np.float64]
AXES = {"nodes": np.argmax, "element_size": np.argmin, "elements_per_radius": np.argmax}
"""Refinements, and where on each the finest grid is."""
_FEWEST = 3


class Side(NamedTuple):
    """A response of one model: value and half-width, (velocities,), SI; the latter NaN if unknown.

    Where nothing bounds the error, the half-width is infinite.
    """

    value: Array
    uncertainty: Array


def applies(runs: xr.Dataset) -> bool:
    """Whether a grid has the 3-D model beside others at three velocities or more."""
    if "beam_model" not in runs.dims or runs.sizes.get("velocity", 0) < _FEWEST:
        return False
    rest = set(runs.dims) - {"time", "x", "z", "velocity", "beam_model", *AXES}
    return SOLID in runs["beam_model"].values and runs.sizes["beam_model"] > 1 and not rest


def models(runs: xr.Dataset) -> list[str]:
    """The 3-D model first, then the others in the study's order."""
    listed = [str(name) for name in runs["beam_model"].values]
    return [SOLID, *(name for name in listed if name != SOLID)]


def label(model: str) -> str:
    """A model of the beam in words."""
    return "3-D solid" if model == SOLID else "-".join(map(str.capitalize, model.split("_")))


def asked(runs: xr.Dataset) -> list[str]:
    """The responses, but for the check of the numerics."""
    return [name for name in responses(runs) if name != "energy_error"]


def finest(runs: xr.Dataset) -> dict[str, int]:
    """Where the finest grid is, by dimension."""
    return {dim: int(at(runs[dim].values)) for dim, at in AXES.items() if dim in runs.dims}


def side(runs: xr.Dataset, analysis: xr.Dataset, name: str, model: str) -> Side:
    """A response of a model against the velocity, in the order of the runs."""
    values = usable(runs, name).sel(beam_model=model).isel(finest(runs), missing_dims="ignore")
    found = values.values.astype(float)
    axis = "element_size" if model == SOLID else "nodes"
    width: Array = abs(found) * _share(analysis, name, model, axis)
    return Side(found, width)


def difference(ours: Side, witness: Side) -> Side:
    """Ours over the witness's, minus one, with the uncertainties of both; NaN where that is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(witness.value != 0.0, ours.value / witness.value, np.nan)
        shares = [abs(each.uncertainty / each.value) for each in (ours, witness)]
    return Side(ratio - 1.0, np.asarray(abs(ratio) * (shares[0] + shares[1])))


def _share(analysis: xr.Dataset, name: str, model: str, axis: str) -> Array:
    """The relative numerical uncertainty of the finest value, NaN where it was not judged."""
    variable = f"{axis}_uncertainty"
    if variable not in analysis or not known(analysis, name):
        return np.array(np.nan)
    chosen = analysis[variable].sel(response=name, beam_model=model)
    chosen = chosen.isel({dim: 0 for dim in AXES if dim in chosen.dims})
    return np.asarray(chosen.values, dtype=float)
