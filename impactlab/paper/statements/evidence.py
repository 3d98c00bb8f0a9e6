"""Numbers out of solved studies, each with its uncertainty from the convergence in nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from impactlab.analysis.convergence.axis import judge
from impactlab.analysis.convergence.richardson import SAFETY_DOUBTFUL
from impactlab.analysis.responses import relevant_bits
from impactlab.paper.statements.claim import Data, Number, UnknownError
from impactlab.variables import RESPONSES, reasons


def runs_of(data: Data, study: str) -> xr.Dataset:
    """The runs of a study. Raises UnknownError where there are none."""
    if study not in data:
        raise UnknownError(f"the study {study} has not been solved")
    return data[study]


def answers(runs: xr.Dataset, response: str, **where: Any) -> xr.DataArray:
    """A response at the labels `where`. Raises UnknownError, saying why, where a run lacks it."""
    try:
        chosen = runs[[response, "status"]].sel(where)
    except KeyError as error:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not have {error.args[0]!r}") from None
    bits = chosen["status"].values & relevant_bits(response)
    gaps = (bits != 0) | ~np.isfinite(chosen[response].values)
    if gaps.any():
        said = reasons(int(np.bitwise_or.reduce(np.ravel(bits)))) or ["no reason is recorded"]
        raise UnknownError(f"{int(gaps.sum())} of {gaps.size} runs lack it: {'; '.join(said)}")
    return chosen[response]


def number(runs: xr.Dataset, response: str, **where: Any) -> Number:
    """A response on the finest grid, with its uncertainty; see `uncertainty`.

    where: a label for every varied parameter but `nodes`. Raises UnknownError where a run of the
    grids is missing.
    """
    if "nodes" not in runs.dims:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not vary the nodes: no uncertainty is known")
    values = answers(runs, response, **where).sortby("nodes", ascending=False)
    found = values.values.astype(float)
    return Number(
        RESPONSES[response].long_name,
        float(found[0]),
        RESPONSES[response].units,
        uncertainty(found, values["nodes"].values),
    )


def uncertainty(values: npt.NDArray[np.float64], nodes: npt.NDArray[Any]) -> float:
    """Half-width about the value on the finest grid: the grid convergence index in its unit.

    values, nodes: (grids,), finest first. Where the grids show no convergence, three times the
    range of the three finest (Eca and Hoekstra's bound for scattered data), so that a value which
    still grows has an uncertainty of its own size. NaN with fewer than three grids.
    """
    if len(values) < 3:
        return float("nan")
    index = judge(values, 1.0 / (nodes - 1.0)).gci
    scatter = SAFETY_DOUBTFUL * float(np.ptp(values[:3]))
    return float(index * abs(values[0])) if np.isfinite(index) else scatter
