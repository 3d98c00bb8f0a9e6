"""Impacts some of which are solved by the 3-D model, beside the kernels' models of the beam."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.solver.jit import SOURCES_HASH as SOLID_HASH
from impactlab.fem3d.study import cost as costs
from impactlab.fem3d.study.cases import is_solid, kernel_cases, table
from impactlab.fem3d.study.running import answers
from impactlab.simulate import solve as solve_cases
from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.design import flattened, run_shape, varied_names
from impactlab.study.netcdf import Columns
from impactlab.study.solvers import Solver, impact
from impactlab.study.store import OutputSpec
from impactlab.variables import WITNESS, described

Array = np.ndarray[Any, Any]

VERSION = hashlib.sha256(f"{SOURCES_HASH} {SOLID_HASH}".encode()).hexdigest()
"""Of the kernels and of the 3-D model."""


def columns(design: xr.Dataset) -> tuple[str, ...]:
    """As of the models of the beam, and what the 3-D model alone tells."""
    return (*impact.columns(design), *WITNESS)


def failures(design: xr.Dataset) -> int:
    """As of the models of the beam."""
    return impact.failures(design)


def cases(design: xr.Dataset, runs: Array) -> Array:
    """The table of fem3d.study.cases of these runs.

    Raises ValueError naming the run when the model refuses a value.
    """
    varied = {name: flattened(design, name, runs) for name in varied_names(design)}
    duration = design["duration"].item()
    return table(*impact.base(design), duration=duration, varied=varied, first_run=int(runs[0]))


def cost(cases: Array) -> Array:
    """Node-steps of the paper's beam, to which seconds of the 3-D model are made equal."""
    return costs.work(cases)


def values(cases: Array, form: OutputSpec) -> int:
    """As of the models of the beam."""
    return impact.values(cases, form)


def solve(cases: Array, form: OutputSpec) -> Columns:
    """The kernels' answers and those of the 3-D model, in the order of the cases."""
    solid = is_solid(cases)
    found = solve_cases(kernel_cases(cases), samples=form.samples).columns()
    columns = {name: _spread(values, ~solid) for name, values in found.items()}
    columns |= {name: np.full(cases.size, np.nan) for name in WITNESS}
    for at in np.flatnonzero(solid):
        for name, value in answers(cases[at], form.samples).items():
            columns[name][at] = value
    return columns


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """The answers of a design's runs, in its order, under its labels and with provenance."""
    dims, shape = run_shape(design)
    own = {name: (dims, answers[name].reshape(shape)) for name in WITNESS}
    return described(impact.labelled(design, answers).assign(own))


def _spread(values: Array, where: Array) -> Array:
    """Rows of (cases, ...): those given where `where` holds, else NaN (0 of whole numbers)."""
    missing = np.nan if values.dtype.kind == "f" else 0
    rows = np.full((where.size, *values.shape[1:]), missing, dtype=values.dtype)
    rows[where] = values
    return rows


SOLVER = Solver(VERSION, columns, failures, cases, cost, values, solve, labelled)
