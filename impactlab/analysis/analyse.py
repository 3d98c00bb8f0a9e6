"""From runs.nc to analysis.nc: every analysis that applies to a study."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import xarray as xr

from impactlab.analysis import failures, sensitivity, surrogate
from impactlab.analysis.convergence import element_size, nodes, points, time_step
from impactlab.analysis.numerical import numerical
from impactlab.variables import ANALYSES


class Analysis(Protocol):
    """What a module of this folder offers to be in the table."""

    def applies(self, runs: xr.Dataset) -> bool:
        """Whether the runs are of the kind that this analysis is about."""

    def analysis(self, runs: xr.Dataset) -> xr.Dataset:
        """Its variables, with `response` among their coordinates."""


_MODULES: dict[str, Analysis] = {
    "failures": failures,
    "convergence_in_nodes": nodes,
    "convergence_in_time_step": time_step,
    "convergence_in_element_size": element_size,
    "convergence_in_points": points,
    "sensitivity": sensitivity,
    "surrogate": surrogate,
}
"""Every analysis there is; a new one is a module, a line here and a line in dataset.ANALYSES."""


def analyse(
    runs: xr.Dataset,
    resolution: xr.Dataset | None = None,
    refinement: xr.Dataset | None = None,
) -> xr.Dataset:
    """Failures, convergence and sensitivity of a study, whichever apply, in one dataset.

    runs: a solved study as in runs.nc, in SI units; of the analyses named in ANALYSES, its
    attribute `analyses` says which are wanted (without it: all). resolution, refinement: what
    adaptive.recommending and adaptive.refining found for this study: add the numerical uncertainty
    of sensitivity indices (see `numerical`). Returns the variables that the applying modules
    document, on `response` and the dimensions that they leave, with the attributes of the runs.
    Raises ValueError when the runs are not what their attributes say.
    """
    wanted = {str(name) for name in np.atleast_1d(runs.attrs.get("analyses", list(ANALYSES)))}
    parts = [
        module.analysis(runs)
        for name, module in _MODULES.items()
        if module.applies(runs) and name not in ANALYSES.keys() - wanted
    ]
    merged = xr.merge(parts, join="exact", compat="equals", combine_attrs="override")
    if resolution is not None or refinement is not None:
        merged = merged.merge(numerical(runs, merged, resolution, refinement), join="exact")
    return merged.assign_attrs(runs.attrs).drop_encoding()
