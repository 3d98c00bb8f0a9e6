"""From runs.nc to analysis.nc: every analysis that applies to a study."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import xarray as xr

from impactlab.analysis import (
    convergence_in_nodes,
    convergence_in_points,
    failures,
    sensitivity,
    surrogate,
)
from impactlab.dataset import ANALYSES


class Analysis(Protocol):
    """What a module of this folder offers to be in the table."""

    def applies(self, runs: xr.Dataset) -> bool:
        """Whether the runs are of the kind that this analysis is about."""

    def analysis(self, runs: xr.Dataset) -> xr.Dataset:
        """Its variables, with `response` among their coordinates."""


_MODULES: tuple[Analysis, ...] = (
    failures,
    convergence_in_nodes,
    convergence_in_points,
    sensitivity,
    surrogate,
)
"""Every analysis there is; a new one is a module, a line here and a line in dataset.ANALYSES."""


def analyse(runs: xr.Dataset) -> xr.Dataset:
    """Failures, convergence and sensitivity of a study, whichever apply, in one dataset.

    runs: a solved study as in runs.nc, in SI units; of the analyses named in ANALYSES, its
    attribute `analyses` says which are wanted (without it: all). Returns the variables that the
    applying modules document, on `response` and the dimensions that they leave, with the
    attributes of the runs. Raises ValueError when the runs are not what their attributes say.
    """
    wanted = {str(name) for name in np.atleast_1d(runs.attrs.get("analyses", list(ANALYSES)))}
    parts = [
        module.analysis(runs)
        for module in _MODULES
        if module.applies(runs) and _name(module) not in ANALYSES.keys() - wanted
    ]
    merged = xr.merge(parts, join="exact", compat="equals", combine_attrs="override")
    return merged.assign_attrs(runs.attrs).drop_encoding()


def _name(module: Analysis) -> str:
    return str(vars(module)["__name__"]).rpartition(".")[2]
