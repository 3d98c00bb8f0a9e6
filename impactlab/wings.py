"""Additions of the wings to the core, imported when they are first needed.

The core never imports a wing: it looks here. What belongs to a model of the beam is asked for only
by studies that have runs of it, so a study without 3-D runs loads nothing of fem3d.
"""

from __future__ import annotations

from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

COMMANDS = {
    "paper": "impactlab.paper.command:paper",
    "witness": "impactlab.fem3d.command:witness",
}
"""Commands, by name: module and function, as `pkgutil.resolve_name` takes them."""
COMPILE = "impactlab.fem3d.solver.solve:compile_all"
"""What compiles the kernels of the 3-D model."""
SOLVERS = {"witness": "impactlab.fem3d.study:SOLVER"}
"""Solvers of runs, see study.solvers, by the name that designs hold."""
SOLID = {
    "cases": "impactlab.fem3d.study",
    "figures": "impactlab.fem3d.figures.witness:FIGURES",
    "sections": "impactlab.fem3d.report:sections",
}
"""What the 3-D model adds to studies that have runs of it: their table of cases and its costs (see
study.estimate), figures by name and sections of the report."""


def added(what: str, runs: xr.Dataset) -> Any:
    """Return an entry of SOLID where some of the runs are 3-D, else None."""
    models = runs["beam_model"].values if "beam_model" in runs.coords else ()
    return resolve_name(SOLID[what]) if "solid" in models else None
