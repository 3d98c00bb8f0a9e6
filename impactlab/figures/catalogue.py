"""The registry of figures; a new one is a record in its module and a line here."""

import xarray as xr

from impactlab.analysis.distribution import limits
from impactlab.figures import (
    access,
    convergence,
    distributions,
    grids,
    indices,
    labels,
    measures,
    samples,
    single_runs,
    strikes,
)
from impactlab.figures.record import LEAD, Figure
from impactlab.methods import FAMILIES, indices_of
from impactlab.variables import of_function

ANSWERS = (
    strikes.strike_series,
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
    grids.compared_values,
    convergence.nodes_convergence,
    convergence.time_step_convergence,
    convergence.points_convergence,
    convergence.convergence_cost,
    distributions.response_distributions,
    distributions.cumulative_distributions,
)
OF_FUNCTIONS = (
    grids.parameter_effects,
    grids.compared_values,
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


_LEADING = (
    *(family.figure for family in FAMILIES),
    "parameter_effects",
    "compared_values",
    "nodes_convergence",
    "element_size_convergence",
    "time_step_convergence",
    "points_convergence",
    "response_distributions",
)
"""Figures of a panel per response whose panel of the headline's response leads a report."""
_PANELS = 2
"""Most panels of a figure that leads a report as it is."""


def _lead(runs: xr.Dataset, analysis: xr.Dataset, base: Figure) -> Figure:
    """Return a figure of one panel per response with the panel of the headline's response alone."""
    names = access.responses(runs)
    if base is not grids.parameter_effects:
        names = [name for name in names if access.known(analysis, name)] or names
        names = [name for name in names if access.is_sound(analysis, name)] or names
    response = access.leading(runs, names)

    def alone(runs: xr.Dataset) -> xr.Dataset:
        return runs.drop_vars([name for name in access.responses(runs) if name != response])

    def judged(analysis: xr.Dataset) -> xr.Dataset:
        return analysis.sel(response=[response]) if access.known(analysis, response) else analysis

    return Figure(
        LEAD,
        f"{base.title}: {labels.response(response)}",
        lambda runs, analysis: len(access.responses(runs)) > _PANELS,
        lambda runs, analysis: base.plot(alone(runs), judged(analysis)),
        lambda runs, analysis: base.caption(alone(runs), judged(analysis)),
    )


def applicable(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, Figure]:
    """Return the figures that apply to a study, by name, in the order of the report."""
    further = access.further_models(runs)
    of_wings = (figure for model in further for figure in model.part("figures").values())
    answers = OF_FUNCTIONS if of_function(runs) else ANSWERS
    scatters = map(samples.scatter, access.responses(runs))
    beyond = [distributions.exceedance(name) for name in limits(runs) if name in runs]
    everything = (*of_wings, *beyond, *answers, *scatters, *INDICES)
    figures = {figure.name: figure for figure in everything if figure.applies(runs, analysis)}
    ranking = [record.family.figure for record in indices_of(runs.attrs)]  # that of the answer
    first = next((figures[name] for name in (*ranking, *_LEADING) if name in figures), None)
    lead = [_lead(runs, analysis, first)] if first else []
    if strikes.strike_series.name in figures:  # what the headline is about
        lead = [strikes.accumulated_dent]
    return {figure.name: figure for figure in lead if figure.applies(runs, analysis)} | figures
