"""The Timoshenko beam with Rayleigh's damping, on Winkler's foundation.

rho A w_tt + alpha rho A w_t + beta (k w - k G A (w_x - psi)_x)_t = Q_x - k w + p,
rho I psi_tt + alpha rho I psi_t - beta (EI psi_xx + k G A (w_x - psi))_t = -M_x + Q,

with the elastic EI and springs of ends where sections yield, too. Steps and the work of damping are
those of resisted_pair.py. The forces of the stiffness's damping are those of the beam's shear and
moments on the last steps of w and psi, which a half step has.
"""

import numpy as np

from impactlab.solver.beam import BeamGrid, BeamState, mirror
from impactlab.solver.jit import inlined, vectorised
from impactlab.solver.resisted_pair import PairResistance, resist
from impactlab.solver.timoshenko import Shear, mirror_rotation, mirror_shear, move
from impactlab.solver.types import ONE, Array


@vectorised
def _strain(u: Array, shear: Shear, resistance: PairResistance, grid: BeamGrid) -> None:
    """Set shear force and moment of the last steps; u: of the deflection."""
    spin, Q, M, per_dx = shear.spin, resistance.force, resistance.moment, 1.0 / grid.dx
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        Q[i] = shear.stiffness * ((u[i + ONE] - u[i]) * per_dx - spin[i])
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        M[i] = -resistance.EI * per_dx * (spin[i] - spin[i - ONE])


@vectorised
def _drag(u: Array, shear: Shear, resistance: PairResistance, grid: BeamGrid) -> None:
    """Set what the stiffness's damping takes."""
    Q, M, lag, per_dx = resistance.force, resistance.moment, resistance.lag, 1.0 / grid.dx
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        resistance.drag[i] = lag * (resistance.bed * u[i] - grid.push * (Q[i] - Q[i - ONE]))
    turn = lag * grid.dt**2 / shear.inertia
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        resistance.other_drag[i] = turn * ((M[i + ONE] - M[i]) * per_dx - Q[i])


@inlined
def move_resisted(
    grid: BeamGrid,
    beam: BeamState,
    shear: Shear,
    resistance: PairResistance,
    now: int,
    F: float,
    per_dx: float,
) -> None:
    """Move rotation and deflection by one step, as timoshenko.move."""
    if resistance.lag > 0.0:
        mirror_rotation(shear.spin, grid)
        _strain(beam.u, shear, resistance, grid)
        mirror_shear(resistance.force, beam.u, grid)
        _drag(beam.u, shear, resistance, grid)
    move(grid, beam, shear, now, F, per_dx)
    resist(beam, now, shear.psi, shear.spin, shear.d_spin, resistance, grid)
    mirror_rotation(shear.psi, grid)
    mirror(beam.w, now, beam.u, grid)
