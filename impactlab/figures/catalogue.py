"""The table of figures: a new one is a new file and a line here."""

from __future__ import annotations

from typing import Protocol

import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import (
    contact_duration,
    contact_laws,
    displacement_history,
    first_contact,
    force_history,
    force_indentation,
    force_indentation_by_law,
    nodes_convergence,
    parameter_effects,
    plastic_strain,
    plastic_strain_depth,
    points_convergence,
    response_distributions,
    shear,
    sobol_indices,
    sobol_second_order,
    surrogate_validation,
)


class FigureFile(Protocol):
    """What a figure's file offers. runs: runs.nc; analysis: analysis.nc; neither is changed."""

    TITLE: str

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Whether the datasets hold what the figure needs."""
        ...

    def plot(self, runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
        """The figure; only where it applies."""
        ...

    def caption(self, runs: xr.Dataset, analysis: xr.Dataset) -> str:
        """What is shown, which values are held, how many runs are missing and why."""
        ...


_FILES: tuple[FigureFile, ...] = (
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
    points_convergence,
    response_distributions,
    sobol_indices,
    sobol_second_order,
    surrogate_validation,
)
CATALOGUE: dict[str, FigureFile] = {
    str(vars(file)["__name__"]).rpartition(".")[2]: file for file in _FILES
}
"""Every figure by name, in the order of the report."""
