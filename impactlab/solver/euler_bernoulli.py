"""The paper's beam while it moves: the differences of beam.py with sections that yield.

Ahead of the wave nothing moves, and between the wave's front and the first section that has
yielded the beam is elastic: such nodes take a shorter loop.
"""

import numpy as np

from impactlab.solver.beam import (
    BeamGrid,
    bending_energy,
    kinetic_energy,
    move,
    move_virgin,
    reach,
    reach_right,
    strike,
)
from impactlab.solver.contact_patch import spread_over_nodes
from impactlab.solver.fibre_plasticity import (
    begin_tangents,
    curvature,
    follow_tangents,
    leave_tangents,
    plastic_energy,
)
from impactlab.solver.jit import allocating, compiled, inlined
from impactlab.solver.section import FibreSection
from impactlab.solver.settle import settle
from impactlab.solver.state import BeamModel, State
from impactlab.solver.types import Array, Record


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Array:
    """Return the first and the last node that the wave has reached, and those that have yielded.

    Of each, the first and the last; none between last and first.
    """
    front = np.empty(4, dtype=np.int64)
    front[0] = front[2] = grid.mid
    front[1], front[3] = grid.mid + 1, grid.mid
    return front


@inlined
def _step(state: State, now: int, F: float) -> None:
    _, section, grid, beam, plastic, front = state
    w, u = beam.w, beam.u
    if plastic.on_tangent[0] > 0 and follow_tangents(
        w, now, None, beam.plastic, plastic.M_0, plastic.on_tangent, plastic.tangent, grid
    ):
        leave_tangents(beam, now, None, plastic, section, grid)
    first, stop, end = front[1], front[3] + 1, front[2] + 1
    outside = move_virgin(w, now, u, front[0], first, grid, section.yield_curvature)
    if first < stop:
        outside += move(
            w, now, u, beam.plastic, plastic.kappa_min, plastic.kappa_max, first, stop, grid
        )
    if stop < end:
        outside += move_virgin(w, now, u, stop, end, grid, section.yield_curvature)
    if outside > 0.0:
        away = begin_tangents(beam, now, None, outside, plastic, section, grid, u, w[1 - now]) + 1
        front[1] = min(front[1], max(grid.mid - away, 2))
        front[3] = max(front[3], min(grid.mid + away, grid.last))
    strike(w, now, u, F, grid)
    front[0] = reach(w, 1 - now, front[0])
    if front[2] < grid.last:
        front[2] = reach_right(w, 1 - now, front[2], grid.last)


@compiled
def _curvature(state: State, now: int) -> float:
    return curvature(state.beam.w, now, None, state.grid, np.uint64(state.grid.mid))


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    stored, dissipated = plastic_energy(state.plastic, state.section, state.grid)
    EI = state.section.stiffness
    elastic = bending_energy(state.beam, state.plastic.M_0, EI, state.grid, now)
    moving = kinetic_energy(state.beam, state.grid, now, u_mid)
    return stored + dissipated + elastic + moving


@compiled
def deflected(state: State, now: int) -> None:
    """Leave the deflections as they are: the step has set them all."""


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    ahead, work, pushed = spread_over_nodes(state.beam, state.grid, now, F, a)
    front, mid = state.extra, state.grid.mid
    front[0] = min(front[0], max(mid - pushed - 2, 2))
    front[2] = max(front[2], min(mid + pushed + 2, state.grid.last))
    return ahead, -work


@compiled
def _settle(state: State) -> None:
    settle(state.beam, state.plastic, state.section, state.grid, 0.0)


MODEL = BeamModel(_make, _step, _curvature, _energy, deflected, _spread, settle=_settle)
