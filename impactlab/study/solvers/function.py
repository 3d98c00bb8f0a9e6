"""Test functions in place of the solver, with known indices, so that a study can be checked."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.shard import Array, Columns
from impactlab.study.solvers import Solver, flattened, on_design
from impactlab.study.store import OutputSpec
from impactlab.verification.functions import FUNCTIONS, sources_hash

VALUE = "value"
"""The name of the one response."""
_MOST = max(len(function.ranges) for function in FUNCTIONS.values())
_CASE = np.dtype([("function", "U20"), ("x", "f8", (_MOST,))])


def cases(design: xr.Dataset, runs: Array) -> Array:
    """Return the function's name and point, one record per run; short points end in zeros."""
    name = str(design.attrs["function"])
    points = np.array([flattened(design, key, runs) for key in FUNCTIONS[name].ranges])
    table = np.zeros(points.shape[1], dtype=_CASE)
    table["function"] = name
    table["x"][:, : len(points)] = points.T
    return table


def solve(cases: Array, output: OutputSpec) -> Columns:
    """Return the function's value at each point; nothing can fail."""
    value = np.zeros(cases.size)
    for name in np.unique(cases["function"]).tolist():
        rows = cases["function"] == name
        function = FUNCTIONS[name]
        value[rows] = function.value(cases["x"][rows, : len(function.ranges)])
    return {VALUE: value, "status": np.zeros(cases.size, dtype=np.int32)}


def labelled(design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
    """Return `value` and `status` on the design's dimensions."""
    title = FUNCTIONS[str(design.attrs["function"])].title
    attrs = {VALUE: {"long_name": f"value of the {title}", "units": "1"}}
    return on_design(design, {name: answers[name] for name in (VALUE, "status")}, attrs)


SOLVER = Solver(
    version=sources_hash(),
    columns=lambda design: (VALUE, "status"),
    cases=cases,
    cost=lambda cases: np.full(cases.size, 100.0),
    values=lambda cases, output: 2,
    solve=solve,
    labelled=labelled,
)
