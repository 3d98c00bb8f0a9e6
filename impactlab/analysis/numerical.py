"""Numerical uncertainty of sensitivity indices, as a variable beside each of them.

It is measured where the sample was solved again on other grids. Elsewhere it is bounded by the
uncertainty of the responses, as if none of it were common to all runs.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.responses import usable
from impactlab.analysis.sensitivity import refinement as refining
from impactlab.analysis.sensitivity.indices import Fit
from impactlab.analysis.surrogate import fit
from impactlab.analysis.verdicts import ROUND_OFF, Verdict, flagged

_GRID = ("nodes", "points", "courant")
_MEASURED = (
    "change of the index with half the spacing and with more points, on the first {} base samples, "
    "extrapolated to the limit, where numerical_from says so; elsewhere "
)
_BOUND = "2 e sqrt(S) + e^2 of an index S, with e^2 the numerical_share"


class NumericalFrom(Verdict):
    """The basis of the numerical uncertainty of a response's indices."""

    MEASURED = 0, True, "the change of the indices themselves on finer grids"
    BOUND = 1, True, "a cautious bound from the error of the response in corner cases"
    NOTHING = 2, False, "nothing tells what the discretisation does to the indices"


def numerical(
    runs: xr.Dataset,
    analysis: xr.Dataset,
    resolution: xr.Dataset | None = None,
    refinement: xr.Dataset | None = None,
    fit: Fit = fit,
) -> xr.Dataset:
    """Return the numerical uncertainty of each response, and of its indices; no unit.

    runs: a sample; analysis: its indices; resolution, refinement: see adaptive.recommendation and
    adaptive.refining, of the same study; fit: see `sensitivity.analysis`.

    Returns of a resolution numerical_uncertainty (response), relative, the worst over the corner
    cases, and numerical_share (response), (u/sigma)^2 with u the root mean square of the
    uncertainty over the corner cases and sigma the standard deviation over the runs; of a
    refinement <order>_change (response, parameter) and its interval, see sensitivity.refinement.
    Of either <order>_numerical (response, parameter), by how much the first_order and the
    total_order may be off, and numerical_from (response). An index S lies between 0 and 1: it is
    off by no more than the larger of S and 1 - S, whatever bounds the error or not. Raises
    ValueError when resolution or refinement is not of these runs.

    The bound: an index is the square of the length of a projection of the response over that of
    the response, and an error of relative length e moves either length by no more than e, so that
    an index S is moved by no more than about 2 e sqrt(S) + e^2.
    """
    found = {} if resolution is None else _of_responses(runs, resolution)
    changed = xr.Dataset() if refinement is None else _changed(runs, refinement, fit)
    nothing = xr.full_like(analysis["response"], np.inf, dtype=float).reset_coords(drop=True)
    share = found.get("numerical_share", nothing)
    orders = [order for order in refining.ORDERS if order in analysis]
    for order in orders:
        bound = _bound(analysis[order], share)
        measured = changed.get(order, xr.full_like(bound, np.nan))
        amount = _within(xr.where(measured.notnull(), measured, bound), analysis[order])
        found[f"{order}_numerical"] = amount.assign_attrs(
            long_name=f"how far the {_words(order)} index may be off numerically",
            units="1",
            estimator=_estimator(refinement),
        )
    if orders:
        measured = changed[orders[0]].notnull().any("parameter") if changed else share.isnull()
        found["numerical_from"] = _from(measured, share)
    parts = xr.Dataset(found), changed.drop_vars(refining.ORDERS, errors="ignore")
    return xr.merge(parts, join="exact", compat="equals").reset_coords(drop=True)


def _of_responses(runs: xr.Dataset, resolution: xr.Dataset) -> dict[str, xr.DataArray]:
    _same(runs, resolution)
    values = usable(runs)
    deviation = values.std([dim for dim in values.dims if dim != "response"])
    asked = resolution.sel(response=values["response"].values)
    squares = (asked["grid_uncertainty"] ** 2).mean("case")
    share = (squares / deviation.where(deviation > 0) ** 2).where(squares > 0, 0.0)
    return {
        "numerical_uncertainty": asked["grid_relative"]
        .reset_coords(drop=True)
        .assign_attrs(
            long_name="relative numerical uncertainty, the worst of the corner cases", units="1"
        ),
        "numerical_share": share.fillna(np.inf)
        .reset_coords(drop=True)
        .assign_attrs(long_name="share of the variance that may be numerical error", units="1"),
    }


def _changed(runs: xr.Dataset, refinement: xr.Dataset, fit: Fit) -> xr.Dataset:
    """Return the described variables of sensitivity.refinement."""
    _same_values(runs, refinement)
    found = refining.uncertainty(refinement, fit)
    used = f"on the first {refinement.attrs['base_samples']} base samples"
    for order in refining.ORDERS:
        words = f"change of the {_words(order)} index with half the spacing, {used}"
        found[f"{order}_change"].attrs = {"long_name": words, "units": "1"}
        found[f"{order}_change_interval"].attrs = {
            "long_name": f"half-width of the interval of the {words}",
            "units": "1",
        }
    return found


def _bound(index: xr.DataArray, share: xr.DataArray) -> xr.DataArray:
    length = index.clip(min=0.0) ** 0.5
    return 2.0 * share**0.5 * length + share


def _within(amount: xr.DataArray, index: xr.DataArray) -> xr.DataArray:
    """Limit the amount to what keeps the index between 0 and 1; NaN without an index."""
    most = (1.0 - index).where(index < 0.5, index)
    return amount.where(amount < most, most).where(index.notnull()).transpose(*index.dims)


def _from(measured: xr.DataArray, share: xr.DataArray) -> xr.DataArray:
    otherwise = xr.where(np.isfinite(share), NumericalFrom.BOUND, NumericalFrom.NOTHING)
    codes = xr.where(measured, NumericalFrom.MEASURED, otherwise)
    return flagged(codes, NumericalFrom, "what the numerical uncertainty of the indices rests on")


def _estimator(refinement: xr.Dataset | None) -> str:
    if refinement is None:
        return _BOUND
    return _MEASURED.format(refinement.attrs["base_samples"]) + _BOUND


def _words(order: str) -> str:
    return order.replace("_", "-")


def _same(runs: xr.Dataset, resolution: xr.Dataset) -> None:
    again = f"make it again (impactlab recommend studies/{runs.attrs.get('study', 'NAME')}.yaml)"
    for name in _GRID:
        here, there = runs[name].values, resolution.attrs.get(f"grid_{name}")
        if here.ndim or here != there:
            raise ValueError(
                f"the resolution was found for {name} = {there}, the runs have {here}: {again}"
            )
    if runs.attrs.get("study_sha256") != resolution.attrs.get("study_sha256"):
        raise ValueError(f"the resolution was found for another text of the study file: {again}")


def _same_values(runs: xr.Dataset, refinement: xr.Dataset) -> None:
    """Raise ValueError unless the used grid of the refinement gives what the runs give."""
    there = usable(refinement).sel(grid=refining.USED)
    here = usable(runs).reindex(response=there["response"], run=there["run"])
    here = here.transpose(*there.dims)
    if not np.allclose(here, there, rtol=ROUND_OFF, atol=0.0, equal_nan=True):
        raise ValueError(
            "the refinement was made from other runs: make it again (impactlab refine "
            f"results/{runs.attrs.get('study', 'NAME')}/runs.nc)"
        )
