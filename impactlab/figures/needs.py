"""The grid that each response of a convergence study needs: for answer, tables and captions."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.analysis.verdicts import TOLERANCE
from impactlab.figures import access, labels
from impactlab.figures.access import usable
from impactlab.figures.measures import analysed
from impactlab.model.parameters import REFINEMENTS

ORDERED = {dim: axis for dim, (axis, _) in REFINEMENTS.items() if dim != "points"}
"""Refined axes: the prefix of their variables in the analysis."""
REFINED = ORDERED | {"points": "points"}
_KINDS = ("rule", "scheme")
"""Discretisations side by side: an answer names the one that needs least."""


class Needs(NamedTuple):
    """The coarsest grid that keeps each response within tolerance.

    A value counts as within where its difference to the finest grid and the uncertainty of that
    grid add up to no more, here and on all finer grids, at each point of the rest of the grid.
    runs: finest first, of the rule and scheme that need least. axes: that were judged. grids: by
    response that has one, its positions on the axes. errors: by response, on (*axes), relative.
    """

    runs: xr.Dataset
    axes: list[str]
    grids: dict[str, tuple[int, ...]]
    errors: dict[str, xr.DataArray]

    def words(self, need: tuple[int, ...]) -> str:
        """Return a grid in words: "201 nodes and 7 points, Gauss-Lobatto"."""
        told = []
        for dim, at in zip(self.axes, need, strict=True):
            one = self.runs[dim]
            text = f"{dim.replace('_', ' ')} {labels.values(one, [at])[0]}{labels.unit(one)}"
            told.append(labels.value(one, at) if dim in ("nodes", "points") else text)
        kinds = [self.runs[dim] for dim in _KINDS if dim in self.runs.dims]
        return ", ".join([labels.listing(told), *(labels.values(kind, [0])[0] for kind in kinds)])

    def doubts(self, analysis: xr.Dataset, name: str) -> list[str]:
        """Return the verdicts on a response at the finest grid that are warnings."""
        said: list[str] = []
        for dim in self.axes:
            verdict = at_finest(analysis.sel(response=name), self.runs, REFINED[dim])
            if verdict and not verdict.sound and verdict.words not in said:
                said.append(verdict.words)
        return said


def needed(runs: xr.Dataset, analysis: xr.Dataset) -> Needs | None:
    """Return the grids that a study needs, None where no axis was judged."""
    axes = []
    for dim, axis in REFINED.items():
        if dim in runs.dims:
            runs = runs.sortby(dim, ascending=REFINEMENTS[dim].cost_power < 0)  # the finest first
            if f"{axis}_uncertainty" in analysis:
                axes.append(dim)
            else:
                runs = runs.isel({dim: 0})
    kinds = [dim for dim in _KINDS if dim in runs.dims]
    tried = []
    names = analysed(runs, analysis) if axes else []
    for kind in product(*(runs[dim].values.tolist() for dim in kinds)) if names else ():
        here = runs.sel({dim: [value] for dim, value in zip(kinds, kind, strict=True)})
        tried.append(_least(here, analysis.sel(response=names), axes))
    return max(tried, key=lambda one: len(one.grids), default=None)  # the first of equals


def _least(runs: xr.Dataset, analysis: xr.Dataset, axes: list[str]) -> Needs:
    cost = xr.ones_like(runs[axes[0]], float)
    for dim in axes:
        cost = cost * runs[dim].astype(float) ** REFINEMENTS[dim].cost_power
    names = analysis["response"].values.tolist()
    values = xr.Dataset({name: usable(runs, name) for name in names}).to_array("response")
    limit = values.isel(dict.fromkeys(axes, 0))
    error = abs(values - limit) / abs(limit)
    for dim in axes:
        error = error + finest(analysis[f"{REFINED[dim]}_uncertainty"], runs)
    same = (values == limit).all(axes)  # as is a plastic strain that is zero everywhere
    error = error.fillna(np.inf).where(~same, 0.0).transpose("response", *axes, ...)
    error = error.max(error.dims[1 + len(axes) :])
    within = (error <= TOLERANCE).astype(int)
    for dim in axes:
        within = within.cumprod(dim)
    best = cost.where(within == 1, np.inf).transpose(*error.dims).argmin(axes)
    grids = {
        name: tuple(int(best[dim].sel(response=name)) for dim in axes)
        for name, found in zip(names, within.any(axes).values, strict=True)
        if found
    }
    return Needs(runs, axes, grids, {name: error.sel(response=name) for name in names})


def finest(array: xr.DataArray, runs: xr.Dataset) -> xr.DataArray:
    """Return a variable of the analysis at the finest grid of the runs, and of their kind."""
    at = [dim for dim in (*REFINED, *_KINDS) if dim in array.dims]
    return array.sel({dim: runs[dim].values.flat[0] for dim in at}, drop=True)


def at_finest(analysis: xr.Dataset, runs: xr.Dataset, axis: str) -> access.Verdict | None:
    """Return the worst verdict on one response at the finest grid, and over the physics."""
    key = f"{axis}_verdict" if f"{axis}_verdict" in analysis else f"{axis}_summary"
    return access.occurring(finest(analysis[key], runs))[-1] if key in analysis else None
