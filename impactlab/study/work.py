"""What is to be solved of a design, a row a run, without a table of all cases in memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.design import run_count
from impactlab.study.solvers import solver_named, solver_of
from impactlab.study.storage import Form, run_keys

Array = np.ndarray[Any, Any]
_CHUNK = 10_000
"""Runs whose cases are in memory together."""


@dataclass(frozen=True)
class Work:
    """The runs of a design: the key of each, shape (runs,), and its cost in the solver's unit."""

    design: xr.Dataset
    solver: str
    form: Form
    keys: Array
    cost: Array

    @staticmethod
    def of(design: xr.Dataset) -> Work:
        """Every run is checked. Raises ValueError naming one that the model refuses."""
        name, form = solver_of(design), Form.of(design)
        solver = solver_named(name)
        keys, cost = [], []
        for start in range(0, run_count(design), _CHUNK):
            stop = min(start + _CHUNK, run_count(design))
            cases = solver.cases(design, np.arange(start, stop))
            keys.append(run_keys(cases, form, solver.VERSION))
            cost.append(solver.cost(cases))
        return Work(design, name, form, np.concatenate(keys), np.concatenate(cost))

    @property
    def size(self) -> int:
        """The number of runs."""
        return int(self.keys.size)

    def cases(self, runs: Array) -> Array:
        """The cases of these runs, by number."""
        return solver_named(self.solver).cases(self.design, runs)
