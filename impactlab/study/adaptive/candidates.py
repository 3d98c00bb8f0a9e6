"""Every combination of rungs: what it costs and how uncertain its answers are."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import xarray as xr

from impactlab.model.cost import node_steps
from impactlab.simulate import case_table
from impactlab.study.adaptive.axes import AXES
from impactlab.study.declaration import Study

FLOOR = 0.1
"""Uncertainties are relative to the value, or to this share of the largest over the cases."""
_POINT_COST = 0.05
"""What a further integration point adds to the cost of a run, relative to its node-steps, where
fibres yield; measured on the paper's beam at 15 and 20 m/s (tests/benchmarks/kernel.py)."""


def candidates(found: xr.Dataset, study: Study, tolerance: float) -> dict[str, xr.DataArray]:
    """The combinations of the rungs of `found`, the cheapest first.

    Returns on (candidate): candidate_nodes, candidate_points, candidate_courant and candidate_cost,
    relative to the study's own discretisation; candidate_uncertainty (response, candidate),
    relative, the worst over the cases; reached (response), whether one meets the tolerance.
    """
    rungs = np.array(list(product(*(found[axis].values for axis in AXES))), dtype=float)
    own = study.discretisation
    price = np.array([_cost(study, *rung) for rung in rungs.tolist()])
    price /= _cost(study, own.nodes, own.points, own.courant)
    order = np.argsort(price, kind="stable")
    columns = {
        axis: xr.DataArray(column, dims="candidate")
        for axis, column in zip(AXES, rungs[order].T, strict=True)
    }
    parts = [_worst(found, axis).sel({axis: columns[axis]}).drop_vars(axis) for axis in AXES]
    worst = (parts[0] + parts[1] + parts[2]).transpose("response", "candidate")
    return {f"candidate_{axis}": column for axis, column in columns.items()} | {
        "candidate_cost": xr.DataArray(price[order], dims="candidate"),
        "candidate_uncertainty": worst,
        "reached": (worst <= tolerance).any("candidate"),
    }


def cheapest(found: xr.Dataset, tolerance: float) -> int:
    """The first candidate that is good enough wherever one is; -1 where none is for anything."""
    wanted = found["asked"] & found["reached"]
    if not bool(wanted.any()):
        return -1
    meets = (found["candidate_uncertainty"] <= tolerance) | ~wanted
    enough = meets.all("response").values
    return int(np.argmax(enough)) if enough.any() else -1


def relative(amount: xr.DataArray, value: xr.DataArray) -> xr.DataArray:
    """Amounts over values, these at least FLOOR of the largest; nothing over nothing is nothing."""
    size = abs(value)
    floor = FLOOR * size.max("case")
    scale = size.where(size > floor, floor)
    share = (amount / scale.where(scale > 0)).where(amount != 0, 0.0)
    return share.fillna(np.inf)


def _worst(found: xr.Dataset, axis: str) -> xr.DataArray:
    reference = found["nodes_value"].isel(nodes=-1, drop=True)
    return relative(found[f"{axis}_uncertainty"], reference).max("case")


def _cost(study: Study, nodes: float, points: float, courant: float) -> float:
    grid = replace(study.discretisation, nodes=int(nodes), points=int(points), courant=courant)
    steps = float(node_steps(case_table(study.impact, grid, duration=study.duration)[0]))
    return steps * (1.0 + _POINT_COST * points)
