"""What is in a runs dataset: its responses, what was varied, on which dimensions."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from impactlab.model.parameters import PARAMETERS
from impactlab.variables import RESPONSES, status_bits

SAMPLED = ("time", "x", "z")
"""Dimensions within a run; every other dimension of a variable of runs.nc is the design's."""


def names(runs: xr.Dataset, attribute: str) -> list[str]:
    """A list attribute; netCDF gives a list of one back as a plain string."""
    return [str(name) for name in np.atleast_1d(runs.attrs.get(attribute, []))]


def varied(runs: xr.Dataset) -> list[str]:
    """Names of the varied parameters that the dataset has, in the study file's order."""
    return [name for name in names(runs, "varied") if name in runs.coords]


def responses(runs: xr.Dataset) -> list[str]:
    """Names of the responses that are stored: in the order of the table of variables, then others.

    Others, which the study asks for and the table does not know, are those of another solver.
    """
    others = [name for name in names(runs, "responses") if name not in RESPONSES]
    return [name for name in [*RESPONSES, *others] if name in runs.data_vars]


def known(analysis: xr.Dataset, response: str) -> bool:
    """Whether the analysis has a response."""
    return "response" in analysis.coords and response in analysis["response"].values


def design_dims(runs: xr.Dataset, dims: Iterable[object] | None = None) -> list[str]:
    """The dimensions that number the runs (of `dims`, if given), in their order."""
    return [str(dim) for dim in (runs.dims if dims is None else dims) if dim not in SAMPLED]


def is_sample(runs: xr.Dataset) -> bool:
    """Whether the runs are a random sample (dimension `run`) and not a grid."""
    return "run" in runs.dims


def physical(runs: xr.Dataset) -> list[str]:
    """The varied parameters of the impact itself that are numbers (not those of the numerics)."""
    return [name for name in varied(runs) if _physical(name) and runs[name].dtype.kind in "if"]


def _physical(name: str) -> bool:
    """Whether it is no parameter of the discretisation; those of functions are none."""
    return name not in PARAMETERS or PARAMETERS[name].path[0] == "impact"


def count(runs: xr.Dataset) -> int:
    """How many runs the design has."""
    return int(np.prod([runs.sizes[dim] for dim in design_dims(runs)], dtype=int))


def usable(runs: xr.Dataset, name: str) -> xr.DataArray:
    """A variable of the runs with NaN where the run's status says that it does not hold."""
    if "status" not in runs:
        return runs[name]
    bits = status_bits([name] if name in RESPONSES else [])
    return runs[name].where((runs["status"] & bits) == 0)
