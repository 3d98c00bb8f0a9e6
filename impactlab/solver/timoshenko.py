"""The Timoshenko beam: transverse shear and rotary inertia, by staggered central differences.

rho A w_tt = Q_x + p, rho I psi_tt = -M_x + Q, Q = k G A (w_x - psi), with the section's moment
M = M_0 - EI kappa as everywhere in the kernels, but of the curvature kappa = psi_x; shear stays
elastic. w and M at nodes, psi and Q half-way to the next node. Source: S. Timoshenko, Phil. Mag. 41
(1921) 744.
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import (
    FREE,
    PINNED,
    SPRUNG,
    BeamGrid,
    BeamState,
    copies,
    mirror,
)
from impactlab.solver.fibre_plasticity import (
    PlasticState,
    begin_tangents,
    follow_tangents,
    leave_tangents,
)
from impactlab.solver.jit import allocating, compiled, inlined, summing, vectorised
from impactlab.solver.section import FibreSection
from impactlab.solver.settle import rest_nodes, static_shape
from impactlab.solver.types import ONE, Array, Record


class Shear(NamedTuple):
    """The state of a Timoshenko beam besides BeamState; all arrays (last + 3,).

    stiffness = k G A (N); inertia = rho I (kg m). psi: rotation, spin = dt psi_t its increment,
    d_spin the last change of that (rad), Q (N): half-way from node i to i + 1 at index i. M (N m):
    at nodes.
    """

    stiffness: float
    inertia: float
    psi: Array
    spin: Array
    d_spin: Array
    Q: Array
    M: Array


@allocating
def make(case: Record, section: FibreSection, grid: BeamGrid) -> Shear:
    """Return the state at rest."""
    size = grid.last + 3
    return Shear(
        case.shear_stiffness,
        case.rotary_inertia,
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
    )


@inlined
def bend_sections(
    section: FibreSection,
    grid: BeamGrid,
    beam: BeamState,
    plastic: PlasticState,
    shear: Shear,
    now: int,
) -> float:
    """Set the moments of the fibres where a step begins; return 1/dx."""
    psi = shear.psi
    if plastic.on_tangent[0] > 0 and follow_tangents(
        beam.w, now, psi, beam.plastic, plastic.M_0, plastic.on_tangent, plastic.tangent, grid
    ):
        leave_tangents(beam, now, psi, plastic, section, grid)
    EI, per_dx = section.stiffness, 1.0 / grid.dx
    outside = _moments(shear, plastic, EI, per_dx, grid.last)
    if outside > 0.0:
        begin_tangents(beam, now, psi, outside, plastic, section, grid, beam.du, beam.du[:0])
        _moments(shear, plastic, EI, per_dx, grid.last)
    return per_dx


@inlined
def mirror_rotation(psi: Array, grid: BeamGrid) -> None:
    """Set the rotations beyond both ends, half-way from node i to i + 1 at index i.

    They are odd about an end that is clamped or symmetric, even about a free one, where the section
    does not bend, and in between about an elastic one; half-way from a pinned end lies no such
    node.
    """
    if grid.left == SPRUNG:
        psi[1] = (1.0 - 2.0 * grid.turn_left) * psi[2]
    elif grid.left != PINNED:
        psi[1] = psi[2] if grid.left == FREE else -psi[2]
    if grid.right == SPRUNG:
        psi[grid.last] = (1.0 - 2.0 * grid.turn_right) * psi[grid.last - 1]
    elif grid.right != PINNED:
        psi[grid.last] = psi[grid.last - 1] if grid.right == FREE else -psi[grid.last - 1]


@inlined
def mirror_shear(Q: Array, w: Array, grid: BeamGrid) -> None:
    """Set the shear forces beyond the ends, as mirror_rotation; odd, but where nothing moves.

    w: deflections (m), against which the springs of elastic ends push.
    """
    Q[grid.first - 2] = -Q[grid.first - 1]
    if grid.right != PINNED:
        Q[grid.last] = -Q[grid.last - 1]
    if grid.left == SPRUNG:
        Q[1] += grid.lift_left * grid.stiffness / grid.push * w[2]
    if grid.right == SPRUNG:
        Q[grid.last] -= grid.lift_right * grid.stiffness / grid.push * w[grid.last]


@inlined
def move(grid: BeamGrid, beam: BeamState, shear: Shear, now: int, F: float, per_dx: float) -> None:
    """Move rotation and deflection by one step, under the moments and the contact force F (N)."""
    Q, mid = shear.Q, grid.mid
    _rotate(beam.w, now, shear, grid.dt**2 / shear.inertia, per_dx, grid.first - 1, grid.stop)
    mirror_rotation(shear.psi, grid)
    mirror_shear(Q, beam.w[now], grid)
    _shift(beam.w, now, beam.u, beam.du, Q, grid.push, F / copies(grid, mid), mid, 2)
    if grid.last > mid:
        _shift(beam.w, now, beam.u, beam.du, Q, grid.push, 0.0, grid.last, mid + 1)
    mirror(beam.w, now, beam.u, grid)


@vectorised
def _moments(
    shear: Shear, plastic_state: PlasticState, EI: float, per_dx: float, last: int
) -> float:
    """Set the moments at the nodes; return how many sections are outside their elastic interval."""
    psi, M, M_0 = shear.psi, shear.M, plastic_state.M_0
    outside = 0.0
    for i in range(np.uint64(2), np.uint64(last + 1)):
        kappa = (psi[i] - psi[i - ONE]) * per_dx
        outside += 1.0 if kappa > plastic_state.kappa_max[i] else 0.0
        outside += 1.0 if kappa < plastic_state.kappa_min[i] else 0.0
        M[i] = M_0[i] - EI * kappa
    return outside


@vectorised
def _rotate(
    w: Array, now: int, shear: Shear, turn: float, per_dx: float, start: int, stop: int
) -> None:
    """Set the shear force half-way between nodes and move the rotation; turn = dt^2/(rho I).

    start, stop: the ends.
    """
    psi, spin, d_spin, Q, M = shear.psi, shear.spin, shear.d_spin, shear.Q, shear.M
    for i in range(np.uint64(start), np.uint64(stop)):
        Q[i] = shear.stiffness * ((w[now, i + ONE] - w[now, i]) * per_dx - psi[i])
        d_spin[i] = turn * (Q[i] - (M[i + ONE] - M[i]) * per_dx)
        spin[i] += d_spin[i]
        psi[i] += spin[i]


@vectorised
def _shift(
    w: Array,
    now: int,
    u: Array,
    du: Array,
    Q: Array,
    push: float,
    F: float,
    mid: int,
    start: int,
) -> None:
    """Move the deflection from `start` to `mid`, where F acts; push = dt^2/(rho A dx)."""
    after = 1 - now
    for i in range(np.uint64(start), np.uint64(mid)):
        du[i] = push * (Q[i] - Q[i - ONE])
        u[i] += du[i]
        w[after, i] = w[now, i] + u[i]
    du[mid] = push * (Q[mid] - Q[mid - 1] + F)
    u[mid] += du[mid]
    w[after, mid] = w[now, mid] + u[mid]


@summing
def shear_energy(beam: BeamState, shear: Shear, M_0: Array, EI: float, grid: BeamGrid) -> float:
    """Return the beam's energy in J after a step, at its beginning, without plastic strains'.

    Kinetic as in beam.py, of deflection and rotation; elastic of bending (see there) and shear.
    """
    u, du, spin, d_spin, last = beam.u, beam.du, shear.spin, shear.d_spin, grid.last
    moved, turned, bent, sheared = 0.0, 0.0, 0.0, 0.0
    for i in range(np.uint64(grid.first), np.uint64(grid.stop)):
        moved += u[i] * (u[i] - du[i])
        bent += shear.M[i] * shear.M[i] - M_0[i] * M_0[i]
    if grid.stop == last:
        moved += 0.5 * u[last] * (u[last] - du[last])
        bent += 0.5 * (shear.M[last] * shear.M[last] - M_0[last] * M_0[last])
    if grid.first > 2:
        moved += 0.5 * u[2] * (u[2] - du[2])
        bent += 0.5 * (shear.M[2] * shear.M[2] - M_0[2] * M_0[2])
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        turned += spin[i] * (spin[i] - d_spin[i])
        sheared += shear.Q[i] * shear.Q[i]
    moving = (grid.mu * moved + shear.inertia * turned) / grid.dt**2
    return 0.5 * grid.copies * grid.dx * (moving + bent / EI + sheared / shear.stiffness)


@compiled
def spring_energy(beam: BeamState, now: int, psi: Array, spin: Array, grid: BeamGrid) -> float:
    """Return the energy (J) of elastic ends after a step, at its beginning.

    Half a spacing beside an end has its part of that of rotation among the sections'.
    """
    EI_per_dx = grid.stiffness / grid.factor * grid.dx
    total, last = 0.0, grid.last
    for kind, end, i, turn, lift in (
        (grid.left, 2, 2, grid.turn_left, grid.lift_left),
        (grid.right, last, last - 1, grid.turn_right, grid.lift_right),
    ):
        if kind == SPRUNG:
            deflection, slope = beam.w[now, end] / grid.dx, psi[i] - spin[i]
            total += 0.25 * lift * deflection * deflection + turn * (1.0 - turn) * slope * slope
    return grid.copies * EI_per_dx * total


@inlined
def rest(
    section: FibreSection,
    grid: BeamGrid,
    beam: BeamState,
    plastic: PlasticState,
    shear: Shear,
    M_0: Array,
    bed: float,
) -> None:
    """Let nothing move, in the static shape under the moments M_0 (N m).

    bed: stiffness of the foundation (N/m2).
    """
    EI, softness = section.stiffness, 1.0 / shear.stiffness
    Q = static_shape(beam.w[0], shear.psi, M_0, EI, softness, grid, bed)
    for i in range(shear.Q.size):
        if grid.first <= i < grid.stop:
            Q += grid.dx * bed * beam.w[0, i]
        shear.Q[i], shear.spin[i], shear.d_spin[i] = Q, 0.0, 0.0
    rest_nodes(beam, grid)
    mirror_rotation(shear.psi, grid)
    _moments(shear, plastic, section.stiffness, 1.0 / grid.dx, grid.last)
