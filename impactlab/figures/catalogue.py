"""The registry of figures; a new one is a record in its module and a line here."""

from __future__ import annotations

import xarray as xr

from impactlab.analysis.distribution import limits
from impactlab.figures import (
    access,
    convergence,
    distributions,
    grids,
    indices,
    measures,
    samples,
    single_runs,
)
from impactlab.figures.record import Figure
from impactlab.methods import FAMILIES
from impactlab.variables import of_function

ANSWERS = (
    grids.contact_laws,
    single_runs.first_contact,
    single_runs.force_history,
    single_runs.displacement_history,
    single_runs.force_indentation,
    single_runs.force_indentation_by_law,
    grids.contact_duration,
    grids.restitution_velocity,
    single_runs.plastic_strain,
    single_runs.plastic_strain_depth,
    grids.shear,
    grids.parameter_effects,
    convergence.nodes_convergence,
    convergence.time_step_convergence,
    convergence.points_convergence,
    convergence.convergence_cost,
    distributions.response_distributions,
    distributions.cumulative_distributions,
)
OF_FUNCTIONS = (
    grids.parameter_effects,
    distributions.response_distributions,
    distributions.cumulative_distributions,
)
"""Those of the answers of a function in place of the solver; the others are of impacts."""
INDICES = (
    indices.index_bars(measures.SOBOL),
    indices.sobol_second_order,
    *map(indices.index_convergence, measures.SOBOL.measures),
    indices.indices_over_time,
    indices.morris_plane,
    *(
        indices.index_bars(family)
        for family in FAMILIES
        if family not in (measures.SOBOL, measures.MORRIS)
    ),
    indices.index_bars(measures.SURROGATE),
    samples.surrogate_validation,
    samples.failure_shares,
    samples.failure_map,
)
CATALOGUE = {figure.name: figure for figure in (*ANSWERS, *INDICES)}
"""Every figure by name, in the order of the report, but for those of a single response."""


def applicable(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, Figure]:
    """Return the figures that apply to a study, by name, in the order of the report."""
    further = access.further_models(runs)
    of_wings = (figure for model in further for figure in model.part("figures").values())
    answers = OF_FUNCTIONS if of_function(runs) else ANSWERS
    scatters = map(samples.scatter, access.responses(runs))
    beyond = [distributions.exceedance(name) for name in limits(runs) if name in runs]
    everything = (*of_wings, *beyond, *answers, *scatters, *INDICES)
    return {figure.name: figure for figure in everything if figure.applies(runs, analysis)}
