"""Test functions in the place of the solver: indices are known, so that a study can be checked."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.dataset import described, provenance
from impactlab.reference.functions import FUNCTIONS, sources_hash
from impactlab.simulate import Answers
from impactlab.study.design import flattened, run_shape
from impactlab.study.storage import Form

Array = np.ndarray[Any, Any]

VALUE = "value"
"""The name of the one response."""
RESPONSE = np.dtype([(VALUE, "f8"), ("status", "i4")])
VERSION = sources_hash()
_MOST = max(len(function.RANGES) for function in FUNCTIONS.values())
_CASE = np.dtype([("function", "U20"), ("x", "f8", (_MOST,))])
_COST = 100.0


def cases(design: xr.Dataset) -> Array:
    """The function's name and its point, a record a run; a shorter point is filled with zeros."""
    name = str(design.attrs["function"])
    points = np.array([flattened(design, key) for key in FUNCTIONS[name].RANGES])
    table = np.zeros(points.shape[1], dtype=_CASE)
    table["function"] = name
    table["x"][:, : len(points)] = points.T
    return table


def cost(cases: Array) -> Array:
    """The same for all."""
    return np.full(cases.size, _COST)


def values(cases: Array, form: Form) -> int:
    """One number and its status."""
    return len(RESPONSE.names or ())


def solve(cases: Array, form: Form) -> Answers:
    """The function's value at each point; nothing can fail."""
    responses = np.zeros(cases.size, dtype=RESPONSE)
    for name in np.unique(cases["function"]).tolist():
        here = cases["function"] == name
        function = FUNCTIONS[name]
        responses[VALUE][here] = function.value(cases["x"][here, : len(function.RANGES)])
    return Answers(responses, {}, {})


def labelled(design: xr.Dataset, answers: Answers) -> xr.Dataset:
    """`value` and `status` on the design's dimensions."""
    dims, shape = run_shape(design)
    title = FUNCTIONS[str(design.attrs["function"])].TITLE
    value = answers.responses[VALUE].reshape(shape)
    status = answers.responses["status"].reshape(shape)
    attrs = {"long_name": f"value of the {title}", "units": "1"}
    dataset = design.assign({VALUE: (dims, value, attrs), "status": (dims, status)})
    return described(dataset.assign_attrs(provenance()))
