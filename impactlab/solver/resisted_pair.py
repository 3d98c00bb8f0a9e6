"""Rayleigh's damping and Winkler's foundation of a beam with two displacements.

These are the deflection at nodes and, half-way between them, Timoshenko's rotation
(resisted_shear.py) or the axial displacement of a beam that stretches (resisted_stretch.py). Steps
and the work of damping are as in resistance.py: the mass's damping is central, the stiffness's lags
by half a step.
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import CLAMPED, BeamGrid, BeamState, copies
from impactlab.solver.jit import allocating, compiled, inlined, vectorised
from impactlab.solver.section import FibreSection
from impactlab.solver.types import Array, Record


class PairResistance(NamedTuple):
    """Damping and foundation of a beam with two displacements; all arrays (last + 3,).

    drag, other_drag: what the stiffness's damping takes from u and from the other displacement in a
    step. force (N), moment (N m): shear or axial force and moment of the last steps of both. lost,
    h, lag, bed and acts as in resistance.py; EI (N m2).
    """

    drag: Array
    other_drag: Array
    force: Array
    moment: Array
    lost: Array
    h: float
    lag: float
    bed: float
    EI: float
    acts: bool


@allocating
def make_resistance(case: Record, section: FibreSection, grid: BeamGrid) -> PairResistance:
    """Return the state at rest."""
    size = grid.last + 3
    return PairResistance(
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(1),
        0.5 * case.mass_damping * grid.dt,
        case.stiffness_damping / grid.dt,
        grid.dt**2 * case.foundation_stiffness / grid.mu,
        section.stiffness,
        case.mass_damping > 0.0 or case.stiffness_damping > 0.0 or case.foundation_stiffness > 0.0,
    )


@compiled
def rest_resistance(resistance: PairResistance) -> None:
    """Let nothing be damped."""
    for i in range(resistance.drag.size):
        resistance.drag[i] = resistance.other_drag[i] = 0.0
    resistance.lost[0] = 0.0


@compiled
def _moving(grid: BeamGrid) -> tuple[int, int]:
    """Return the first node that moves and the one after the last."""
    return (
        grid.first if grid.left == CLAMPED else 2,
        grid.stop if grid.right == CLAMPED else grid.last + 1,
    )


@vectorised
def _work_of_step(
    beam: BeamState,
    v: Array,
    dv: Array,
    inertia: float,
    resistance: PairResistance,
    grid: BeamGrid,
    share: float,
) -> float:
    """Return the work (J) of damping in the last step, or with `share` 0 in its first half."""
    u, du, h = beam.u, beam.du, resistance.h
    start, stop = _moving(grid)
    moved, other = 0.0, 0.0
    for i in range(np.uint64(start), np.uint64(stop)):
        force = resistance.drag[i] + h * (2.0 * u[i] - du[i])
        moved += copies(grid, i) * force * (u[i] - du[i] + share * u[i])
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        force = resistance.other_drag[i] + h * (2.0 * v[i] - dv[i])
        other += force * (v[i] - dv[i] + share * v[i])
    inertia = grid.copies * inertia
    return 0.5 * grid.dx / grid.dt**2 * (grid.mu * moved + inertia * other)


@vectorised
def resist(
    beam: BeamState,
    now: int,
    place: Array,
    v: Array,
    dv: Array,
    resistance: PairResistance,
    grid: BeamGrid,
) -> None:
    """Mend a step that was made without resistance.

    place: the other displacement, v its increment, dv the last change of that.
    """
    w, u, du, after, h = beam.w, beam.u, beam.du, 1 - now, resistance.h
    start, stop = _moving(grid)
    for i in range(np.uint64(start), np.uint64(stop)):
        loss = resistance.drag[i] + resistance.bed * w[now, i] + h * (2.0 * u[i] - du[i])
        change = -loss / (1.0 + h)
        u[i] += change
        du[i] += change
        w[after, i] += change
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        loss = resistance.other_drag[i] + h * (2.0 * v[i] - dv[i])
        change = -loss / (1.0 + h)
        v[i] += change
        dv[i] += change
        place[i] += change


@inlined
def take_work(
    beam: BeamState,
    v: Array,
    dv: Array,
    inertia: float,
    resistance: PairResistance,
    grid: BeamGrid,
) -> None:
    """Count the work of damping in the step before: another one begins.

    v, dv: as in `resist`; inertia: of the other displacement, per length.
    """
    resistance.lost[0] += _work_of_step(beam, v, dv, inertia, resistance, grid, 1.0)


@compiled
def resisted_energy(
    beam: BeamState,
    now: int,
    v: Array,
    dv: Array,
    inertia: float,
    resistance: PairResistance,
    grid: BeamGrid,
) -> float:
    """Return the foundation's energy and the work of damping (J), where a step begins."""
    squares = 0.0
    for i in range(2, grid.last + 1):
        squares += 0.5 * copies(grid, i) * resistance.bed * beam.w[now, i] * beam.w[now, i]
    half = _work_of_step(beam, v, dv, inertia, resistance, grid, 0.0)
    return resistance.lost[0] + half + grid.mu * grid.dx / grid.dt**2 * squares
