"""The one judgement of a convergence study: of answer, figures, captions and tables alike."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import usable
from impactlab.figures.measures import analysed
from impactlab.model.parameters import REFINEMENTS
from impactlab.variables import of_function
from impactlab.verdicts import TOLERANCE

ORDERED = {dim: axis for dim, (axis, _) in REFINEMENTS.items() if dim != "points"}
"""Refined axes: the prefix of their variables in the analysis."""
REFINED = ORDERED | {"points": "points"}
_KINDS = ("rule", "scheme")
"""Discretisations side by side: an answer names the one that needs least."""


class Needs(NamedTuple):
    """The coarsest grid that keeps each response within tolerance, and the verdicts behind it.

    A value counts as within where its difference to the finest grid and the uncertainty of that
    grid add up to no more, here and on all finer grids, for all the rest of the study; and where
    the finest grid has a sound verdict on each axis. runs: finest first, of the rule and scheme
    that need least. axes: that were judged. grids: by response that has one, its positions on the
    axes. errors: by response, on (*axes), relative. analysis: at the finest grid of the runs, on
    (response, *rest of the study).
    """

    runs: xr.Dataset
    axes: list[str]
    grids: dict[str, tuple[int, ...]]
    errors: dict[str, xr.DataArray]
    analysis: xr.Dataset

    def words(self, need: tuple[int, ...]) -> str:
        """Return a grid in words: "201 nodes and 7 points, Gauss-Lobatto"."""
        return self._words(dict(zip(self.axes, need, strict=True)))

    def beside(self, axis: str) -> str:
        """Return the finest grid without an axis in words: "21 points, Gauss-Lobatto"."""
        varied = [dim for dim, name in REFINED.items() if dim in self.runs.dims and name != axis]
        return self._words(dict.fromkeys(varied, 0))

    def _words(self, positions: dict[str, int]) -> str:
        levels = []
        for dim, position in positions.items():
            level = self.runs[dim]
            text = f"{dim.replace('_', ' ')} {labels.values(level, [position])[0]}"
            counted = dim in ("nodes", "points")
            levels.append(labels.value(level, position) if counted else text + labels.unit(level))
        kinds = [self.runs[dim] for dim in _KINDS if dim in self.runs.dims]
        parts = [labels.listing(levels), *(labels.values(kind, [0])[0] for kind in kinds)]
        return ", ".join(filter(None, parts))

    def verdict(self, axis: str, name: str) -> access.StatedVerdict | None:
        """Return the worst verdict on a response at the finest grid, over the rest of the study."""
        if f"{axis}_verdict" not in self.analysis or not access.known(self.analysis, name):
            return None
        return access.occurring(self.analysis[f"{axis}_verdict"].sel(response=name))[-1]

    def doubts(self, name: str) -> list[str]:
        """Return why no grid keeps a response within tolerance; none where one does."""
        axes: dict[str, list[str]] = {}
        for dim in self.axes:
            verdict = self.verdict(REFINED[dim], name)
            if verdict and not verdict.sound:
                axes.setdefault(verdict.words, []).append(labels.response(REFINED[dim]))
        doubts = [f"{texts} in {labels.listing(listed)}" for texts, listed in axes.items()]
        if doubts or name in self.grids:
            return doubts
        listed = [labels.response(REFINED[dim]) for dim in self.axes]
        return [f"the uncertainties in {labels.listing(listed)} add up"]


_Judgements = dict[tuple[int, int], tuple["Needs | None", xr.Dataset, xr.Dataset]]
_judgements: ContextVar[_Judgements | None] = ContextVar("judgements", default=None)


@contextmanager
def judged_once() -> Iterator[None]:
    """Judge each pair of datasets once in this context, in which they must not change."""
    token = _judgements.set({})
    try:
        yield
    finally:
        _judgements.reset(token)


def needed(runs: xr.Dataset, analysis: xr.Dataset) -> Needs | None:
    """Return the grids that a study needs, None where no axis was judged."""
    judgements = _judgements.get()
    if judgements is None:
        return _judged(runs, analysis)
    pair = id(runs), id(analysis)
    if pair not in judgements:  # the datasets stay in memory, for no other to have their id
        judgements[pair] = _judged(runs, analysis), runs, analysis
    return judgements[pair][0]


def _judged(runs: xr.Dataset, analysis: xr.Dataset) -> Needs | None:
    if of_function(runs):
        return None
    axes = []
    for dim, axis in REFINED.items():
        if dim in runs.dims:
            runs = runs.sortby(dim, ascending=REFINEMENTS[dim].cost_power < 0)  # the finest first
            if f"{axis}_uncertainty" in analysis:
                axes.append(dim)
            else:
                runs = runs.isel({dim: [0]})
    kinds = [dim for dim in _KINDS if dim in runs.dims]
    tried = []
    names = analysed(runs, analysis) if axes else []
    for kind in product(*(runs[dim].values.tolist() for dim in kinds)) if names else ():
        selected = runs.sel({dim: [value] for dim, value in zip(kinds, kind, strict=True)})
        tried.append(_least(selected, analysis.sel(response=names), axes))
    return max(
        tried, key=lambda candidate: len(candidate.grids), default=None
    )  # the first of equals


def _least(runs: xr.Dataset, analysis: xr.Dataset, axes: list[str]) -> Needs:
    cost = access.bare(xr.ones_like(runs[axes[0]], float))
    for dim in axes:
        cost = cost * access.bare(runs[dim]).astype(float) ** REFINEMENTS[dim].cost_power
    names = analysis["response"].values.tolist()
    values = xr.Dataset({name: access.bare(usable(runs, name)) for name in names}).to_array(
        "response"
    )
    limit = values.isel(dict.fromkeys(axes, 0))
    error = abs(values - limit) / abs(limit)
    judged = analysis.map(finest, keep_attrs=True, runs=runs)
    sound = xr.ones_like(judged["response"], bool)
    for axis in (REFINED[dim] for dim in axes):
        error = error + judged[f"{axis}_uncertainty"]
        verdicts = judged[f"{axis}_verdict"]
        is_sound = verdicts.isin(
            [verdict.value for verdict in access.occurring(verdicts) if verdict.sound]
        )
        sound = sound & is_sound.all([dim for dim in verdicts.dims if dim != "response"])
    same = (values == limit).all(axes)  # as is a plastic strain that is zero everywhere
    error = error.fillna(np.inf).where(~same, 0.0).transpose("response", *axes, ...)
    error = error.max(error.dims[1 + len(axes) :])
    within = ((error <= TOLERANCE) & sound).astype(int)
    for dim in axes:
        within = within.cumprod(dim)
    best = cost.where(within == 1, np.inf).transpose(*error.dims).argmin(axes)
    grids = {
        name: tuple(int(best[dim].sel(response=name)) for dim in axes)
        for name, is_within in zip(names, within.any(axes).values, strict=True)
        if is_within
    }
    errors = {name: error.sel(response=name) for name in names}
    return Needs(runs, axes, grids, errors, judged)


def finest(array: xr.DataArray, runs: xr.Dataset, but: str = "") -> xr.DataArray:
    """Return a variable of the analysis at the finest grid of the runs, and of their kind.

    but: a dimension that is left.
    """
    dims = [dim for dim in (*REFINED, *_KINDS) if dim in array.dims and dim != but]
    return array.sel({dim: runs[dim].values.flat[0] for dim in dims}, drop=True)
