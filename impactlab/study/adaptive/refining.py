"""The first base samples of a Sobol sample, solved again on other grids."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.analysis.responses import in_order, listed
from impactlab.study.solvers import solver_of

MOST, FEWEST, SHARE = 64, 16, 8
"""Base samples that are solved again: at most, at least, and as a share (1/SHARE) of all."""
COARSEST = 25
"""Fewest nodes of a coarser grid that still resembles the beam."""
Solve = Callable[[xr.Dataset], xr.Dataset]


def refine_cases(runs: xr.Dataset, solve: Solve, count: int | None = None) -> xr.Dataset:
    """Return the first base samples on the grid of the runs and on others, all else unchanged.

    runs: a Sobol sample of impacts, as in runs.nc. solve: returns the runs of a design, which
    includes the grid of the runs. count: base samples to solve again; None: see `base_samples`.

    The result is on (run, grid), in SI units, with the attributes of a Sobol sample of so many
    base_samples without second order. `grid` is "used"; "finer", with half the spacing (and at the
    same courant a smaller time step); "more_points" over the depth, nearly twice as many; and
    "coarser", with about twice the spacing, where that leaves COARSEST nodes; nodes and points
    (grid) describe each. Raises ValueError where the runs are no such sample, OSError when the disk
    is full or no scheduler answers.
    """
    study, method = runs.attrs.get("study", "?"), runs.attrs.get("method", "none")
    if method != "sobol":
        raise ValueError(
            f"study {study!r}: its runs are of method {method}, but only those of sobol can be "
            "refined"
        )
    if "function" in runs.attrs or solver_of(runs) in wings.SOLVERS:
        raise ValueError(f"study {study!r}: its runs are not of a beam model, so they have no grid")
    names, first = listed(runs, "varied"), _first(in_order(runs), count).compute()
    nodes, points = int(runs["nodes"]), int(runs["points"])
    grids = {
        "used": (nodes, points),
        "finer": (2 * nodes - 1, points),
        "more_points": (nodes, 2 * points - 1),
    }
    coarser = 2 * round((nodes - 1) / 4) + 1  # odd, for a node in the middle
    if coarser >= COARSEST:
        grids["coarser"] = coarser, points
    beside = [name for name, values in first.coords.items() if set(values.dims) - {"run"}]
    design = first.drop_vars([*first.data_vars, *beside, "nodes", "points"]).assign_coords(
        grid=("grid", list(grids), {"long_name": "discretisation"}),
        nodes=("grid", [nodes for nodes, _ in grids.values()]),
        points=("grid", [points for _, points in grids.values()]),
    )
    solved = solve(design.assign_attrs(varied=[*names, "nodes", "points"], histories=0, profiles=0))
    return solved.assign_attrs(varied=names)


def base_samples(whole: int) -> int:
    """Return how many base samples are solved again: half-widths fall with their square root."""
    return min(whole, max(FEWEST, min(MOST, whole // SHARE)))


def _first(runs: xr.Dataset, count: int | None) -> xr.Dataset:
    """Return the runs of the first base samples: at A, at A with one column of B each, and at B."""
    whole = int(runs.attrs["base_samples"])
    step, second = runs.sizes["run"] // whole, int(runs.attrs["second_order"])
    factors = (step - 2) // (2 if second else 1)
    wanted = [*range(factors + 1), step - 1]  # before the last: B with columns of A
    count = min(whole, count or base_samples(whole))
    places = np.add.outer(step * np.arange(count), wanted).ravel()
    attrs: dict[str, Any] = {"base_samples": count, "second_order": 0}
    return runs.isel(run=places).assign_attrs(attrs)
