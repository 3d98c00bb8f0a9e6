"""Test functions in place of the solver, with known indices, so that a study can be checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.design import flattened, run_shape
from impactlab.study.netcdf import Columns
from impactlab.study.solvers import Solver
from impactlab.study.store import OutputSpec
from impactlab.variables import described, provenance
from impactlab.verification.functions import FUNCTIONS, sources_hash

Array = np.ndarray[Any, Any]

VALUE = "value"
"""The name of the one response."""
_MOST = max(len(function.ranges) for function in FUNCTIONS.values())
_CASE = np.dtype([("function", "U20"), ("x", "f8", (_MOST,))])
_COST = 100.0


def columns(design: xr.Dataset) -> tuple[str, ...]:
    """Return the names of the value and its status, for any function."""
    return (VALUE, "status")


def failures(design: xr.Dataset) -> int:
    """Return no bits: every run has its value."""
    return 0


def cases(design: xr.Dataset, runs: Array) -> Array:
    """Return the function's name and point, one record per run; short points end in zeros."""
    name = str(design.attrs["function"])
    points = np.array([flattened(design, key, runs) for key in FUNCTIONS[name].ranges])
    table = np.zeros(points.shape[1], dtype=_CASE)
    table["function"] = name
    table["x"][:, : len(points)] = points.T
    return table


def cost(cases: Array) -> Array:
    """Return the same cost for all cases."""
    return np.full(cases.size, _COST)


def values(cases: Array, output: OutputSpec) -> int:
    """Return two: the value and its status."""
    return 2


def solve(cases: Array, output: OutputSpec) -> Columns:
    """Return the function's value at each point; nothing can fail."""
    value = np.zeros(cases.size)
    for name in np.unique(cases["function"]).tolist():
        here = cases["function"] == name
        function = FUNCTIONS[name]
        value[here] = function.value(cases["x"][here, : len(function.ranges)])
    return {VALUE: value, "status": np.zeros(cases.size, dtype=np.int32)}


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """Return `value` and `status` on the design's dimensions."""
    dims, shape = run_shape(design)
    title = FUNCTIONS[str(design.attrs["function"])].title
    value = answers[VALUE].reshape(shape)
    status = answers["status"].reshape(shape)
    attrs = {"long_name": f"value of the {title}", "units": "1"}
    dataset = design.assign({VALUE: (dims, value, attrs), "status": (dims, status)})
    return described(dataset.assign_attrs(provenance()))


SOLVER = Solver(sources_hash(), columns, failures, cases, cost, values, solve, labelled)
