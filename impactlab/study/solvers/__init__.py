"""Solvers of a study's runs: one file each, and one line in SOLVERS or in a wing's record."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Any

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.methods.runs import listed
from impactlab.provenance import provenance
from impactlab.study.shard import Array, Columns
from impactlab.study.store import OutputSpec
from impactlab.variables import attributes


def run_shape(design: xr.Dataset) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Return the dimensions that number the runs and their sizes; the last one varies fastest.

    They are in the study's order: netCDF does not keep the order of a dataset's own dimensions.
    """
    dims = (str(dim) for name in listed(design, "varied") for dim in design[name].dims)
    once = tuple(dict.fromkeys(dims))
    return once, tuple(design.sizes[dim] for dim in once)


def flattened(design: xr.Dataset, name: str, runs: Array) -> Array:
    """Return a parameter in these runs, numbered along the dimensions in C order: shape (runs,)."""
    dims, shape = run_shape(design)
    places = np.unravel_index(runs, shape)
    indices = tuple(places[dims.index(str(dim))] for dim in design[name].dims)
    values: Array = np.broadcast_to(design[name].values[indices], runs.shape)
    return values


def run_number(design: xr.Dataset, run: int) -> int:
    """Return the number that messages give a run; a block of a design begins later than at 0."""
    return int(design["run"].values[run]) if run_shape(design)[0] == ("run",) else int(run)


def on_design(
    design: xr.Dataset, answers: Mapping[str, Any], attrs: Mapping[str, Mapping[str, Any]]
) -> xr.Dataset:
    """Return answers of one number per run in the design's order; attrs: of each response."""
    dims, shape = run_shape(design)
    function = {"function": design.attrs["function"]}
    attrs = {name: {**entry, **function} for name, entry in attrs.items()}
    attrs["status"] = attributes("status")
    variables = {
        name: (dims, values.reshape(shape), attrs.get(name)) for name, values in answers.items()
    }
    return design.assign(variables).assign_attrs(provenance())


@dataclass(frozen=True, kw_only=True)
class Solver:
    """A solver of runs. Its cases are structured arrays, one record per run."""

    version: str
    """A hash that changes with the answers: answers of another version are not reused."""
    columns: Callable[[xr.Dataset], tuple[str, ...]]
    """Return the names of the answers to a design that `labelled` takes."""
    cases: Callable[[xr.Dataset, Array], Array]
    """Return all that the runs of a design depend on, by number, dimensions flattened.

    Raises ValueError naming a wrong run; the runs then follow each other.
    """
    cost: Callable[[Array], Array]
    """Return the estimated cost of each case; about 3e8 make one second."""
    values: Callable[[Array, OutputSpec], int]
    """Return how many numbers are kept of each case."""
    solve: Callable[[Array, OutputSpec], Columns]
    """Return the answers by name, with `status`, one row per case: the same bits in any batch."""
    labelled: Callable[[xr.Dataset, Mapping[str, Any]], xr.Dataset]
    """Return the answers in the design's order, under its labels and with provenance.

    Answers are those of `solve`, as arrays of NumPy or, not read yet, of dask.
    """
    failures: Callable[[xr.Dataset], int] = lambda design: 0
    """Return the bits of the answer `status` with which a run lacks a requested response."""
    prepare: Callable[[xr.Dataset], object] = lambda design: None
    """Compile what the runs of a design need, before threads ask for it at once."""
    functions: Any = None
    """Python functions that a worker has to know (own.Task)."""


SOLVERS = {
    "impact": "impactlab.study.solvers.kernels:SOLVER",
    "function": "impactlab.study.solvers.function:SOLVER",
} | {model.solver: model.references["solver"] for model in wings.models().values()}
"""References to solvers, by the name that designs hold in their attribute `solver`."""


def solver_named(name: str) -> Solver:
    """Return a solver. Raises ValueError for Python functions that this process does not know."""
    if name.startswith("own "):
        solver: Solver = resolve_name("impactlab.study.solvers.own:solver")(name)
    else:
        solver = resolve_name(SOLVERS[name])
    return solver
