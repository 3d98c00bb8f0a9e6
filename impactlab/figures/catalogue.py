"""The table of figures: a new one is a new file and a line here."""

from __future__ import annotations

from typing import Protocol

import xarray as xr
from matplotlib.figure import Figure

from impactlab import wings
from impactlab.figures import (
    contact_duration,
    contact_laws,
    convergence_cost,
    displacement_history,
    element_size_convergence,
    failure_map,
    failure_shares,
    first_contact,
    force_history,
    force_indentation,
    force_indentation_by_law,
    measures,
    morris_plane,
    nodes_convergence,
    parameter_effects,
    plastic_strain,
    plastic_strain_depth,
    points_convergence,
    response_distributions,
    shear,
    sobol_second_order,
    surrogate_validation,
    time_step_convergence,
)
from impactlab.figures.index_bars import IndexBars
from impactlab.figures.index_convergence import IndexConvergence
from impactlab.figures.scatter import scatters


class FigureFile(Protocol):
    """What a figure's file offers. runs: runs.nc; analysis: analysis.nc; neither is changed."""

    @property
    def TITLE(self) -> str:  # noqa: N802
        """Heads the figure."""
        ...

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Whether the datasets hold what the figure needs."""
        ...

    def plot(self, runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
        """The figure; only where it applies."""
        ...

    def caption(self, runs: xr.Dataset, analysis: xr.Dataset) -> str:
        """What is shown, which values are held, how many runs are missing and why."""
        ...


def _named(*files: FigureFile) -> dict[str, FigureFile]:
    return {str(vars(file)["__name__"]).rpartition(".")[2]: file for file in files}


_ANSWERS: dict[str, FigureFile] = _named(
    contact_laws,
    first_contact,
    force_history,
    displacement_history,
    force_indentation,
    force_indentation_by_law,
    contact_duration,
    plastic_strain,
    plastic_strain_depth,
    shear,
    parameter_effects,
    nodes_convergence,
    time_step_convergence,
    element_size_convergence,
    points_convergence,
    convergence_cost,
    response_distributions,
)
_INDICES: dict[str, FigureFile] = {
    "sobol_indices": IndexBars(measures.SOBOL),
    **_named(sobol_second_order),
    **{
        f"{measure.name}_convergence": IndexConvergence(measure)
        for measure in measures.SOBOL.measures
    },
    **_named(morris_plane),
    "delta_indices": IndexBars(measures.DELTA),
    "pawn_indices": IndexBars(measures.PAWN),
    "regression_indices": IndexBars(measures.REGRESSION),
    "surrogate_indices": IndexBars(measures.SURROGATE),
    **_named(surrogate_validation, failure_shares, failure_map),
}
CATALOGUE = _ANSWERS | _INDICES
"""Every figure by name, in the order of the report, but for those of one response each."""


def applicable(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, FigureFile]:
    """The figures that apply to a study, by name, in the order of the report."""
    of_wings: dict[str, FigureFile] = wings.added("figures", runs) or {}
    everything = of_wings | _ANSWERS | scatters(runs) | _INDICES
    return {name: file for name, file in everything.items() if file.applies(runs, analysis)}
