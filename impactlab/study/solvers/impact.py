"""Impacts, solved by the kernels."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.dataset import HISTORIES, PROFILES, RESPONSES, described, provenance
from impactlab.kernels.jit import SOURCES_HASH
from impactlab.kernels.responses import RESPONSE
from impactlab.model.cost import node_steps
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
from impactlab.simulate import solve as solve_cases
from impactlab.study.design import flattened, run_shape, varied_names
from impactlab.study.storage import Form

__all__ = ["RESPONSE", "VERSION", "cases", "cost", "labelled", "solve", "values"]
VERSION = SOURCES_HASH
cost = node_steps


def cases(design: xr.Dataset) -> np.ndarray[Any, Any]:
    """The kernels' case table of a design, its dimensions flattened in C order.

    Raises ValueError naming the run when the model refuses a value.
    """
    columns = {name: flattened(design, name) for name in varied_names(design)}
    return case_table(*_base(design), duration=design["duration"].item(), varied=columns)


def values(cases: np.ndarray[Any, Any], form: Form) -> int:
    """Responses, histories and profiles of a run; all have the first one's mesh."""
    profile = int(cases[0].nodes) * int(cases[0].points) if form.profiles else 0
    return len(RESPONSES) + len(HISTORIES) * form.samples + len(PROFILES) * profile


def solve(cases: np.ndarray[Any, Any], form: Form) -> Answers:
    """The kernels' answers."""
    return solve_cases(cases, samples=form.samples, profiles=form.profiles)


def labelled(design: xr.Dataset, answers: Answers) -> xr.Dataset:
    """The answers of a design's runs, in its order, under its labels and with provenance."""
    dims, shape = run_shape(design)
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
