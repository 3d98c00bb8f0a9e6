"""From runs.nc to analysis.nc: every analysis that applies to a study."""

from __future__ import annotations

from typing import Protocol

import xarray as xr

from impactlab.analysis import (
    convergence_in_nodes,
    convergence_in_points,
    failures,
    sensitivity,
)


class Analysis(Protocol):
    """What a module of this folder offers to be in the table."""

    def applies(self, runs: xr.Dataset) -> bool:
        """Whether the runs are of the kind that this analysis is about."""

    def analysis(self, runs: xr.Dataset) -> xr.Dataset:
        """Its variables, with `response` among their coordinates."""


ANALYSES: tuple[Analysis, ...] = (
    failures,
    convergence_in_nodes,
    convergence_in_points,
    sensitivity,
)
"""Every analysis there is; a new one is a module and a line here."""


def analyse(runs: xr.Dataset) -> xr.Dataset:
    """Failures, convergence and sensitivity of a study, whichever apply, in one dataset.

    runs: a solved study as in runs.nc, in SI units. Returns the variables that the applying
    modules document, on `response` and the dimensions that they leave, with the attributes of
    the runs. Raises ValueError when the runs are not what their attributes say.
    """
    parts = [module.analysis(runs) for module in ANALYSES if module.applies(runs)]
    merged = xr.merge(parts, join="exact", compat="equals", combine_attrs="override")
    return merged.assign_attrs(runs.attrs).drop_encoding()
