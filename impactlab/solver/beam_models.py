"""The beam models and time schemes beside the paper's: which one a case asks for.

The paper's beam by leapfrog is written out in leapfrog.py, where it can be fastest.
"""

from __future__ import annotations

from typing import NamedTuple

from impactlab.solver import BEAM_MODELS, SCHEMES
from impactlab.solver.beam import Beam, Grid
from impactlab.solver.energy import bending_energy, kinetic_energy, plastic_energy
from impactlab.solver.fibre_plasticity import PlasticState
from impactlab.solver.jit import allocating, compiled
from impactlab.solver.lumped import Lumped, lumped_energy, lumped_step, make_lumped
from impactlab.solver.section import Section
from impactlab.solver.semi_implicit import (
    Filter,
    filtered_kinetic_energy,
    filtered_step,
    make_filter,
    no_filter,
)
from impactlab.solver.timoshenko import Shear, make_shear, shear_energy, shear_step
from impactlab.solver.types import Record

ELASTIC = BEAM_MODELS.index("elastic")
TIMOSHENKO = BEAM_MODELS.index("timoshenko")
SPRING_MASS = BEAM_MODELS.index("spring_mass")
RIGID = BEAM_MODELS.index("rigid")
SEMI_IMPLICIT = SCHEMES.index("semi_implicit")


class ModelState(NamedTuple):
    """The state of models and schemes beside the paper's; empty where a case needs none."""

    filter: Filter
    shear: Shear
    lumped: Lumped


@compiled
def is_explicit(case: Record) -> bool:
    """Return whether a case is of the paper's beam (yielding or not) and scheme."""
    return case.beam_model <= ELASTIC and case.scheme != SEMI_IMPLICIT


@allocating
def make_model_state(case: Record, section: Section, grid: Grid) -> ModelState:
    """Return the state of a beam at rest."""
    filtered = case.beam_model <= ELASTIC and case.scheme == SEMI_IMPLICIT
    return ModelState(
        make_filter(grid, section.stiffness) if filtered else no_filter(),
        make_shear(case, grid.mid + 3 if case.beam_model == TIMOSHENKO else 0),
        make_lumped(case, case.beam_model == RIGID, section.stiffness, grid),
    )


@compiled
def model_step(
    model: int,
    beam: Beam,
    plastic_state: PlasticState,
    section: Section,
    grid: Grid,
    model_state: ModelState,
    now: int,
    F: float,
) -> None:
    """Move the beam by one step under the contact force F (N)."""
    if model == TIMOSHENKO:
        shear_step(beam, model_state.shear, plastic_state, section, grid, now, F)
    elif model <= ELASTIC:
        filtered_step(beam, plastic_state, section, grid, model_state.filter, now, F)
    else:
        lumped_step(beam, model_state.lumped, grid, now, F)


@compiled
def beam_energy(
    model: int,
    beam: Beam,
    plastic_state: PlasticState,
    section: Section,
    grid: Grid,
    model_state: ModelState,
    now: int,
    F: float,
    u_mid: float,
) -> float:
    """Return all energy of the beam in J, stored and dissipated: after a step, at its beginning.

    u_mid (m): u at mid-span before that step.
    """
    stored, dissipated = plastic_energy(plastic_state, section, grid)
    if model > TIMOSHENKO:
        return lumped_energy(beam, model_state.lumped, grid, now)
    if model == TIMOSHENKO:
        elastic = shear_energy(beam, model_state.shear, plastic_state.M_0, section.stiffness, grid)
        return stored + dissipated + elastic
    elastic = bending_energy(beam, plastic_state, section, grid, now)
    if model_state.filter.length > 0:
        moving = filtered_kinetic_energy(beam, grid, model_state.filter, now, F)
    else:
        moving = kinetic_energy(beam, grid, now, u_mid)
    return stored + dissipated + elastic + moving
