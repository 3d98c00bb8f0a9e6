"""The Timoshenko beam with Rayleigh's damping, on Winkler's foundation.

rho A w_tt + alpha rho A w_t + beta (k w - k G A (w_x - psi)_x)_t = Q_x - k w + p,
rho I psi_tt + alpha rho I psi_t - beta (EI psi_xx + k G A (w_x - psi))_t = -M_x + Q,

with the elastic EI and springs of ends where sections yield, too. Steps and the work of damping are
as in resistance.py: the mass's damping is central, the stiffness's lags by half a step. Its forces
are those of the beam's shear and moments on the last steps of w and psi, which a half step has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import CLAMPED, BeamGrid, BeamState, copies, mirror
from impactlab.solver.jit import allocating, compiled, inlined, vectorised
from impactlab.solver.section import FibreSection
from impactlab.solver.timoshenko import Shear, mirror_rotation, mirror_shear, move
from impactlab.solver.types import ONE, Array, Record


class ShearResistance(NamedTuple):
    """Damping and foundation of a Timoshenko beam; all arrays (last + 3,).

    drag (m), twist (rad): what the stiffness's damping takes from u and spin in a step. Q (N), M (N
    m): shear force and moment of the last steps of w and psi. lost, h, lag, bed and acts as in
    resistance.py; EI (N m2).
    """

    drag: Array
    twist: Array
    Q: Array
    M: Array
    lost: Array
    h: float
    lag: float
    bed: float
    EI: float
    acts: bool


@allocating
def make_resistance(case: Record, section: FibreSection, grid: BeamGrid) -> ShearResistance:
    """Return the state at rest."""
    size = grid.last + 3
    return ShearResistance(
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
def rest_resistance(resistance: ShearResistance) -> None:
    """Let nothing be damped."""
    for i in range(resistance.drag.size):
        resistance.drag[i] = resistance.twist[i] = 0.0
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
    beam: BeamState, shear: Shear, resistance: ShearResistance, grid: BeamGrid, share: float
) -> float:
    """Return the work (J) of damping in the last step, or with `share` 0 in its first half."""
    u, du, spin, d_spin, h = beam.u, beam.du, shear.spin, shear.d_spin, resistance.h
    start, stop = _moving(grid)
    moved, turned = 0.0, 0.0
    for i in range(np.uint64(start), np.uint64(stop)):
        force = resistance.drag[i] + h * (2.0 * u[i] - du[i])
        moved += copies(grid, i) * force * (u[i] - du[i] + share * u[i])
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        force = resistance.twist[i] + h * (2.0 * spin[i] - d_spin[i])
        turned += force * (spin[i] - d_spin[i] + share * spin[i])
    inertia = grid.copies * shear.inertia
    return 0.5 * grid.dx / grid.dt**2 * (grid.mu * moved + inertia * turned)


@vectorised
def _strain(u: Array, shear: Shear, resistance: ShearResistance, grid: BeamGrid) -> None:
    """Set shear force and moment of the last steps; u: of the deflection."""
    spin, Q, M, per_dx = shear.spin, resistance.Q, resistance.M, 1.0 / grid.dx
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        Q[i] = shear.stiffness * ((u[i + ONE] - u[i]) * per_dx - spin[i])
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        M[i] = -resistance.EI * per_dx * (spin[i] - spin[i - ONE])


@vectorised
def _drag(u: Array, shear: Shear, resistance: ShearResistance, grid: BeamGrid) -> None:
    """Set what the stiffness's damping takes."""
    Q, M, lag, per_dx = resistance.Q, resistance.M, resistance.lag, 1.0 / grid.dx
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        resistance.drag[i] = lag * (resistance.bed * u[i] - grid.push * (Q[i] - Q[i - ONE]))
    turn = lag * grid.dt**2 / shear.inertia
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        resistance.twist[i] = turn * ((M[i + ONE] - M[i]) * per_dx - Q[i])


@vectorised
def _resist(
    beam: BeamState, now: int, shear: Shear, resistance: ShearResistance, grid: BeamGrid
) -> None:
    """Mend a step that was made without resistance."""
    w, u, du, after, h = beam.w, beam.u, beam.du, 1 - now, resistance.h
    start, stop = _moving(grid)
    for i in range(np.uint64(start), np.uint64(stop)):
        loss = resistance.drag[i] + resistance.bed * w[now, i] + h * (2.0 * u[i] - du[i])
        change = -loss / (1.0 + h)
        u[i] += change
        du[i] += change
        w[after, i] += change
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        loss = resistance.twist[i] + h * (2.0 * shear.spin[i] - shear.d_spin[i])
        change = -loss / (1.0 + h)
        shear.spin[i] += change
        shear.d_spin[i] += change
        shear.psi[i] += change


@inlined
def take_work(beam: BeamState, shear: Shear, resistance: ShearResistance, grid: BeamGrid) -> None:
    """Count the work of damping in the step before: another one begins."""
    resistance.lost[0] += _work_of_step(beam, shear, resistance, grid, 1.0)


@inlined
def move_resisted(
    grid: BeamGrid,
    beam: BeamState,
    shear: Shear,
    resistance: ShearResistance,
    now: int,
    F: float,
    per_dx: float,
) -> None:
    """Move rotation and deflection by one step, as timoshenko.move."""
    if resistance.lag > 0.0:
        mirror_rotation(shear.spin, grid)
        _strain(beam.u, shear, resistance, grid)
        mirror_shear(resistance.Q, beam.u, grid)
        _drag(beam.u, shear, resistance, grid)
    move(grid, beam, shear, now, F, per_dx)
    _resist(beam, now, shear, resistance, grid)
    mirror_rotation(shear.psi, grid)
    mirror(beam.w, now, beam.u, grid)


@compiled
def resisted_energy(
    beam: BeamState, now: int, shear: Shear, resistance: ShearResistance, grid: BeamGrid
) -> float:
    """Return the foundation's energy and the work of damping (J), where a step begins."""
    squares = 0.0
    for i in range(2, grid.last + 1):
        squares += 0.5 * copies(grid, i) * resistance.bed * beam.w[now, i] * beam.w[now, i]
    half = _work_of_step(beam, shear, resistance, grid, 0.0)
    return resistance.lost[0] + half + grid.mu * grid.dx / grid.dt**2 * squares
