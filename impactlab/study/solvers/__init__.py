"""Solvers of a study's runs: one file each, and a line in SOLVERS or in wings.SOLVERS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.study.netcdf import Columns
from impactlab.study.store import Form

Array = np.ndarray[Any, Any]


class Solver(Protocol):
    """What the file of a solver offers. Cases: a structured array, a record a run."""

    VERSION: str
    """A hash that changes with the answers: answers of another version are not reused."""

    def columns(self, design: xr.Dataset) -> tuple[str, ...]:
        """Names of the answers that `labelled` takes."""
        ...

    def failures(self, design: xr.Dataset) -> int:
        """The bits of the answer `status` with which a run lacks something asked for."""
        ...

    def cases(self, design: xr.Dataset, runs: Array) -> Array:
        """All that these runs depend on, by number, dimensions flattened.

        Raises ValueError naming a wrong run; the runs then follow each other.
        """
        ...

    def cost(self, cases: Array) -> Array:
        """Estimated cost of each run; about 3e8 make a second."""
        ...

    def values(self, cases: Array, form: Form) -> int:
        """How many numbers are kept of a run."""
        ...

    def solve(self, cases: Array, form: Form) -> Columns:
        """The answers by name, a row a run, `status` among them; the same bits in any batch."""
        ...

    def labelled(self, design: xr.Dataset, answers: Mapping[str, Any]) -> xr.Dataset:
        """The answers in the design's order, under its labels and with provenance.

        answers: as solve gives them, arrays of numpy or, not read yet, of dask.
        """
        ...


SOLVERS = {
    "impact": "impactlab.study.solvers.impact",
    "function": "impactlab.study.solvers.function",
} | wings.SOLVERS
"""Modules, by the name that designs hold in their attribute `solver`."""


def solver_named(name: str) -> Solver:
    """Return the solver of this name."""
    found: Solver = wings.load(SOLVERS[name])
    return found


def solver_of(design: xr.Dataset) -> str:
    """The name of a design's solver: without the attribute, that of impacts."""
    return str(design.attrs.get("solver", "impact"))
