"""The registry of figures; a new one is a record in its module and a line here."""

from __future__ import annotations

import xarray as xr

from impactlab import wings
from impactlab.figures import (
    convergence,
    effects,
    failures,
    forces,
    index_maps,
    measures,
    samples,
    strains,
    velocity,
)
from impactlab.figures.indices import index_bars, index_convergence
from impactlab.figures.record import Figure

ANSWERS = (
    velocity.CONTACT_LAWS,
    forces.FIRST_CONTACT,
    forces.FORCE_HISTORY,
    forces.DISPLACEMENT_HISTORY,
    forces.FORCE_INDENTATION,
    forces.FORCE_INDENTATION_BY_LAW,
    velocity.CONTACT_DURATION,
    velocity.RESTITUTION_VELOCITY,
    strains.PLASTIC_STRAIN,
    strains.PLASTIC_STRAIN_DEPTH,
    effects.SHEAR,
    effects.PARAMETER_EFFECTS,
    convergence.NODES,
    convergence.TIME_STEP,
    convergence.ELEMENT_SIZE,
    convergence.POINTS,
    convergence.COST,
    samples.DISTRIBUTIONS,
)
INDICES = (
    index_bars("sobol_indices", measures.SOBOL),
    index_maps.SECOND_ORDER,
    *(index_convergence(measure) for measure in measures.SOBOL.measures),
    index_maps.MORRIS_PLANE,
    index_bars("delta_indices", measures.DELTA),
    index_bars("pawn_indices", measures.PAWN),
    index_bars("regression_indices", measures.REGRESSION),
    index_bars("surrogate_indices", measures.SURROGATE),
    samples.SURROGATE_VALIDATION,
    failures.FAILURE_SHARES,
    failures.FAILURE_MAP,
)
CATALOGUE = {figure.name: figure for figure in (*ANSWERS, *INDICES)}
"""Every figure by name, in the order of the report, but for the scatter plots of each response."""


def applicable(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, Figure]:
    """Return the figures that apply to a study, by name, in the order of the report."""
    of_wings: dict[str, Figure] = wings.added("figures", runs) or {}
    everything = (*of_wings.values(), *ANSWERS, *samples.scatters(runs), *INDICES)
    return {figure.name: figure for figure in everything if figure.applies(runs, analysis)}
