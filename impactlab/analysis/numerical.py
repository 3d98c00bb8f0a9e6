"""What the discretisation may have done to sensitivity indices: a bound beside each of them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.responses import usable

_INDICES = ("first_order", "total_order")
_GRID = ("nodes", "points", "courant")


def numerical(runs: xr.Dataset, analysis: xr.Dataset, resolution: xr.Dataset) -> xr.Dataset:
    """The numerical uncertainty of each response, and of its indices.

    runs: a sample; analysis: its indices; resolution: see steering.recommending, of the same study.

    Returns numerical_uncertainty (response), relative, the worst over the corner cases;
    numerical_share (response), (u/sigma)^2 with u the root mean square of the uncertainty over
    the corner cases and sigma the standard deviation over the runs; and first_order_numerical,
    total_order_numerical (response, parameter), where those indices are: by how much they may be
    off. An index is the square of the length of a projection of the response over that of the
    response, and an error of relative length e moves either length by no more than e, so that an
    index S is moved by no more than about 2 e sqrt(S) + e^2. All without unit, infinite where
    nothing bounds the error. Raises ValueError when the resolution is not of these runs.
    """
    _same(runs, resolution)
    values = usable(runs)
    deviation = values.std([dim for dim in values.dims if dim != "response"])
    asked = resolution.sel(response=values["response"].values)
    squares = (asked["grid_uncertainty"] ** 2).mean("case")
    share = (squares / deviation.where(deviation > 0) ** 2).where(squares > 0, 0.0)
    share = share.fillna(np.inf).reset_coords(drop=True)
    found = {
        "numerical_uncertainty": asked["grid_relative"]
        .reset_coords(drop=True)
        .assign_attrs(
            long_name="relative numerical uncertainty, the worst of the corner cases", units="1"
        ),
        "numerical_share": share.assign_attrs(
            long_name="share of the variance that may be numerical error", units="1"
        ),
    }
    for name in _INDICES:
        if name in analysis:
            found[f"{name}_numerical"] = _bound(analysis[name], share).assign_attrs(
                long_name=f"how far the {name.replace('_', '-')} index may be off numerically",
                units="1",
            )
    return xr.Dataset(found)


def _bound(index: xr.DataArray, share: xr.DataArray) -> xr.DataArray:
    length = index.clip(min=0.0) ** 0.5
    return (2.0 * share**0.5 * length + share).where(index.notnull())


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
