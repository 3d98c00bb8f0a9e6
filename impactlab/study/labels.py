"""From the labels of a design to the flat table of cases, and back to a labelled dataset."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.dataset import described, provenance
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.simulate import (
    Answers,
    answer_variables,
    case_table,
    profile_coordinates,
    sample_coordinates,
)


def varied_names(design: xr.Dataset) -> tuple[str, ...]:
    """The varied parameters, in the order of the study."""
    return tuple(str(name) for name in np.atleast_1d(design.attrs["varied"]))


def run_dims(design: xr.Dataset) -> tuple[str, ...]:
    """The dimensions that number the runs; the last one varies fastest.

    In the study's order: the order of a dataset's own dimensions is not kept by netCDF.
    """
    dims = (str(dim) for name in varied_names(design) for dim in design[name].dims)
    return tuple(dict.fromkeys(dims))


def design_cases(design: xr.Dataset) -> np.ndarray[Any, Any]:
    """The kernels' case table of a design, its dimensions flattened in C order.

    Raises ValueError naming the run when the model refuses a value.
    """
    sizes = {dim: design.sizes[dim] for dim in run_dims(design)}
    columns = {
        name: design[name].variable.set_dims(sizes).values.ravel() for name in varied_names(design)
    }
    return case_table(*_base(design), duration=design["duration"].item(), varied=columns)


def labelled(design: xr.Dataset, answers: Answers) -> xr.Dataset:
    """The answers of a design's runs, in its order, under its labels and with provenance."""
    dims = run_dims(design)
    shape = tuple(design.sizes[dim] for dim in dims)
    responses = tuple(str(name) for name in np.atleast_1d(design.attrs["responses"]))
    flat = answer_variables(answers, responses, ("run",))
    variables = {
        name: ((*dims, *others[1:]), values.reshape(*shape, *values.shape[1:]))
        for name, (others, values) in flat.items()
    }
    dataset = design.assign(variables).assign_coords(_answer_coordinates(design, answers))
    return described(dataset.assign_attrs(provenance()))


def _base(design: xr.Dataset) -> tuple[Impact, Discretisation]:
    """The impact and the discretisation of what is not varied."""
    varied = varied_names(design)
    stated = [name for name in PARAMETERS if name in design and name not in varied]
    fixed = {name: design[name].item() for name in stated}
    return with_values(paper_impact(), Discretisation(), fixed)


def _answer_coordinates(design: xr.Dataset, answers: Answers) -> dict[str, Any]:
    coordinates: dict[str, Any] = {}
    if answers.histories:
        coordinates |= sample_coordinates(
            design["duration"].item(), design.attrs["history_samples"]
        )
    if answers.profiles:
        coordinates |= profile_coordinates(*_base(design))
    return coordinates
