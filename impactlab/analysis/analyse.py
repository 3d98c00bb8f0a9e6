"""From runs.nc to analysis.nc: every analysis that applies to a study."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from impactlab.analysis import distribution, sensitivity, surrogate
from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.axes import ELEMENT_SIZE, NODES, TIME_STEP
from impactlab.analysis.numerical import numerical
from impactlab.analysis.responses import labels
from impactlab.analysis.sensitivity import over_time
from impactlab.variables import ANALYSES

_TABLE: dict[str, tuple[Callable[[xr.Dataset], bool], Callable[[xr.Dataset], xr.Dataset]]] = {
    "convergence_in_nodes": (NODES.applies, NODES.analysis),
    "convergence_in_time_step": (TIME_STEP.applies, TIME_STEP.analysis),
    "convergence_in_element_size": (ELEMENT_SIZE.applies, ELEMENT_SIZE.analysis),
    "convergence_in_points": (lambda runs: runs.sizes.get("points", 0) >= 2, points.analysis),
    "sensitivity": (
        lambda runs: runs.attrs.get("method") in sensitivity.METHODS,
        sensitivity.analysis,
    ),
    "sensitivity_over_time": (over_time.applies, over_time.analysis),
    "distribution": (distribution.applies, distribution.analysis),
    "surrogate": (surrogate.applies, surrogate.analysis),
}
"""Every analysis by its name: whether the runs are of the kind that it is about, and its variables,
with `response` or `history` among their coordinates. A new one is one line here and one in
variables.ANALYSES.
"""


def analyse(
    runs: xr.Dataset, resolution: xr.Dataset | None = None, refinement: xr.Dataset | None = None
) -> xr.Dataset:
    """Return convergence, sensitivity and distributions of a study, whichever apply.

    runs: a solved study as in runs.nc, in SI units; of the analyses named in ANALYSES, its
    attribute `analyses` lists the wanted ones (without it: all). resolution, refinement: results of
    adaptive.recommendation and adaptive.sobol for this study, which add the numerical
    uncertainty of sensitivity indices (see `numerical`). Returns the variables that the applying
    analyses document, on `response` and the dimensions that they leave, with the attributes of the
    runs; without any, the coordinates of the responses alone.

    Raises ValueError when the runs are not a study's, or contradict their attributes.

    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=256, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> indices = il.analyse(study.run(workers=1))
    >>> indices.total_order.sel(response="value").round(1).values
    array([0.6, 0.4, 0.2])
    """
    if "responses" not in runs.attrs:
        raise ValueError(
            "the runs are not those of a study: analyse what il.Study(...).run() gives"
        )
    wanted = {str(name) for name in np.atleast_1d(runs.attrs.get("analyses", list(ANALYSES)))}
    parts = [
        analysis(runs)
        for name, (applies, analysis) in _TABLE.items()
        if applies(runs) and name not in ANALYSES.keys() - wanted
    ]
    requested = xr.Dataset(coords=labels(runs))
    merged = xr.merge([requested, *parts], join="exact", compat="equals", combine_attrs="override")
    if resolution is not None or refinement is not None:
        merged = merged.merge(numerical(runs, merged, resolution, refinement), join="exact")
    return merged.assign_attrs(runs.attrs).drop_encoding()
