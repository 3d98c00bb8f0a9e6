"""Refinement levels of the discretisation, and the cost and uncertainty of their combinations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.judgement import numerical_uncertainty
from impactlab.model.cost import node_steps
from impactlab.model.discretisation import Discretisation
from impactlab.simulate import case_table
from impactlab.study.schema.study import Study

Array = NDArray[np.float64]
AXES = ("nodes", "points", "courant")
FLOOR = 0.1
"""Uncertainties are relative to the value, or to this share of the largest over the cases."""
_COARSEST, _FINEST = 50, 800
"""Elements over the span: the finer the last level, the smaller the error that remains."""
_POINTS = (3, 5, 7, 9, 13, 17, 25)
_COURANTS = (0.9, 0.45, 0.225)


@dataclass(frozen=True)
class Levels:
    """Refinement levels of each axis, in order of rising cost."""

    nodes: tuple[int, ...]
    points: tuple[int, ...]
    courant: tuple[float, ...]


def refinement_levels(own: Discretisation) -> Levels:
    """Return the levels to try for a study of this discretisation.

    Spacings are halved, with one level about half-way between. The study's own spacing, half of it
    and a quarter are levels, too, even beyond the finest: finer levels show its error.
    """
    spans = {(own.nodes - 1) * factor for factor in (1, 2, 4)}
    at = _COARSEST
    while at <= _FINEST:
        spans |= {at, 3 * at // 4 * 2}
        at *= 2
    most = max(_FINEST, 4 * (own.nodes - 1))
    return Levels(
        tuple(sorted(each + 1 for each in spans if each <= most)),
        tuple(sorted({*_POINTS, own.points})),
        tuple(sorted({own.courant / factor for factor in (1, 2, 4)} | {*_COURANTS}, reverse=True)),
    )


def uncertainty(values: xr.DataArray, axis: str) -> xr.DataArray:
    """Return the uncertainty of the value on every level, in its unit, infinite where unknown.

    values: on (response, case, axis), the levels in order of rising cost. Points and time step are
    judged by the differences to the costliest level: once fibres yield, the error is no power of
    the points; and changes with the time step at fixed nodes are too small (about 1e-6) and too
    irregular for one.
    """
    finest_first = values.isel({axis: slice(None, None, -1)})
    levels = finest_first[axis].values.astype(float)
    judge = partial(_by_spacing, nodes=levels) if axis == "nodes" else points.numerical_uncertainty
    found: xr.DataArray = xr.apply_ufunc(
        judge, finest_first, input_core_dims=[[axis]], output_core_dims=[[axis]], vectorize=True
    )
    return found.isel({axis: slice(None, None, -1)}).fillna(np.inf)


def _by_spacing(values: Array, nodes: Array) -> Array:
    return numerical_uncertainty(values, 1.0 / (nodes - 1.0)).amounts


_POINT_COST = 0.05
"""Cost of one more integration point, relative to the node-steps of a run where fibres yield;
measured on the paper's beam at 15 and 20 m/s (tests/benchmarks/kernel.py)."""


def grid_options(found: xr.Dataset, study: Study, tolerance: float) -> dict[str, xr.DataArray]:
    """Return all combinations of the levels of `found`, the cheapest first.

    Variables on (candidate): candidate_nodes, candidate_points, candidate_courant and
    candidate_cost, relative to the study's own discretisation; candidate_uncertainty (response,
    candidate), relative, the worst over the cases; reached (response), whether one meets the
    tolerance.
    """
    levels = np.array(list(product(*(found[axis].values for axis in AXES))), dtype=float)
    own = study.discretisation
    price = np.array([_cost(study, *level) for level in levels.tolist()])
    price /= _cost(study, own.nodes, own.points, own.courant)
    order = np.argsort(price, kind="stable")
    columns = {
        axis: xr.DataArray(column, dims="candidate")
        for axis, column in zip(AXES, levels[order].T, strict=True)
    }
    parts = [_worst(found, axis).sel({axis: columns[axis]}).drop_vars(axis) for axis in AXES]
    worst = (parts[0] + parts[1] + parts[2]).transpose("response", "candidate")
    return {f"candidate_{axis}": column for axis, column in columns.items()} | {
        "candidate_cost": xr.DataArray(price[order], dims="candidate"),
        "candidate_uncertainty": worst,
        "reached": (worst <= tolerance).any("candidate"),
    }


def cheapest(found: xr.Dataset, tolerance: float) -> int:
    """Return the first option that is fine enough for all requested responses that any is for.

    Returns -1 where no option is fine enough for any response.
    """
    wanted = found["asked"] & found["reached"]
    if not bool(wanted.any()):
        return -1
    meets = (found["candidate_uncertainty"] <= tolerance) | ~wanted
    enough = meets.all("response").values
    return int(np.argmax(enough)) if enough.any() else -1


def relative(amount: xr.DataArray, value: xr.DataArray) -> xr.DataArray:
    """Return amounts over values, these at least FLOOR of the largest; 0 over 0 is 0."""
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
