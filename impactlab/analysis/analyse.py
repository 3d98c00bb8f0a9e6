"""From runs.nc to analysis.nc: every analysis that applies to a study."""

from __future__ import annotations

from pkgutil import resolve_name
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis import ANALYSES
from impactlab.analysis.numerical import numerical
from impactlab.methods.runs import labels
from impactlab.methods.verdict import with_numerical_error
from impactlab.variables import of_function


def analyse(
    runs: xr.Dataset, resolution: xr.Dataset | None = None, refinement: xr.Dataset | None = None
) -> xr.Dataset:
    """Return convergence, sensitivity and distributions of a study, whichever apply.

    Parameters
    ----------
    runs : xarray.Dataset
        Solved study as in runs.nc, in SI units. Its attribute `analyses` lists the requested
        analyses (impactlab.analysis.ANALYSES); without it, all are.
    resolution : xarray.Dataset, optional
        Result of `Study.recommend` for this study: adds the numerical uncertainty of the responses.
    refinement : xarray.Dataset, optional
        Result of `Study.refine` for this study: adds the measured change of the indices.

    Returns
    -------
    xarray.Dataset
        Variables of the analyses that apply, on `response` and the dimensions that they leave, with
        the attributes of the runs; without any, the coordinates of the responses alone.

    Raises
    ------
    ValueError
        If the runs are not a study's, or contradict their attributes.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=256, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> indices = il.analyse(study.run(workers=1))
    >>> indices.total_order.sel(response="value", parameter=["x2", "x3"]).round(1).values
    array([0.5, 0.2])
    """
    if "responses" not in runs.attrs:
        raise ValueError(
            "the runs are not those of a study: analyse what il.Study(...).run() gives"
        )
    names = {str(name) for name in np.atleast_1d(runs.attrs.get("analyses", list(ANALYSES)))}
    axes = {} if of_function(runs) else runs.sizes  # a function has no discretisation
    plan: Any = runs.attrs.get("method"), axes, True
    entries = [ANALYSES[name] for name in ANALYSES if name in names]
    parts = [resolve_name(entry.place).analysis(runs) for entry in entries if entry.possible(*plan)]
    requested = xr.Dataset(coords=labels(runs))
    merged = xr.merge([requested, *parts], join="exact", compat="equals", combine_attrs="override")
    if "parameter" in merged.coords:
        long_names = [_long_name(runs, str(name)) for name in merged["parameter"].values]
        merged = merged.assign_coords(parameter_long_name=("parameter", long_names))
    if resolution is not None or refinement is not None:
        merged = merged.merge(numerical(runs, merged, resolution, refinement), join="exact")
        merged = with_numerical_error(merged)
    return merged.assign_attrs(runs.attrs).drop_encoding()


def _long_name(runs: xr.Dataset, factor: str) -> str:
    """Return the meaning of a parameter, or the name of a group of them in words."""
    attrs = runs[factor].attrs if factor in runs.coords else {}
    return str(attrs.get("long_name", factor.replace("_", " ")))
