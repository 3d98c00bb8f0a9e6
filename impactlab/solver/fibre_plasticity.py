"""The beam's sections while they yield.

As long as a section is bent on in one direction and no further fibre begins to yield, its moment
follows a straight line, the tangent, and its fibres need not be touched: they are caught up with
when the section turns back, when a further fibre begins to yield, or when they are asked for.
Return mapping with linear hardening does not depend on the number of steps taken in one
direction, so nothing is lost.

Sections that yield by the rate (strain_rate.py) are on no tangent: they flow a little in every step
in which they are outside their static interval.
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver.beam import SPRUNG, BeamGrid, BeamState, add_moment, copies
from impactlab.solver.jit import allocating, compiled, joined, summing
from impactlab.solver.section import (
    FAR,
    FibreSection,
    bend,
    bend_at_rate,
    dissipated_energy,
    stored_energy,
    tangent,
)
from impactlab.solver.strain_rate import RateLaw
from impactlab.solver.types import ONE, TWO, Array, Index


class PlasticState(NamedTuple):
    """The memory of each section; indices as in beam.py.

    M_0 (N m) and kappa_min, kappa_max (1/m): the elastic interval, (last + 3,); without limits in a
    section on its tangent. on_tangent: the number of these, then which they are, (last + 4,).
    tangent: (last + 3, 4), of these the direction (1 or -1), the growth of M_0 with kappa (N m2),
    the curvature at which a further fibre yields, and the present one (1/m). plastic_strain and
    peeq of the fibres, (last + 3, P // 2). flowed: where the yield stress depends on the rate, a
    section's curvature after its last flow (1/m) and the work of the overstress (J/m), as long as
    M_0, by 2.
    """

    M_0: Array
    kappa_min: Array
    kappa_max: Array
    on_tangent: Array
    tangent: Array
    plastic_strain: Array
    peeq: Array
    flowed: Array


@allocating
def make_plastic_state(grid: BeamGrid, section: FibreSection) -> PlasticState:
    """Return the state of sections that have never yielded."""
    size, fibres = grid.last + 3, section.z.size
    return PlasticState(
        np.zeros(size),
        np.full(size, -section.yield_curvature),
        np.full(size, section.yield_curvature),
        np.zeros(size + 1, dtype=np.uint64),
        np.zeros((size, 4)),
        np.zeros((size, fibres)),
        np.zeros((size, fibres)),
        np.zeros((size, 2)),
    )


@compiled
def rest_plastic_state(plastic: PlasticState, section: FibreSection) -> None:
    """Make the sections ones that have never yielded."""
    for i in range(plastic.M_0.size):
        plastic.M_0[i] = plastic.flowed[i, 0] = plastic.flowed[i, 1] = 0.0
        plastic.kappa_min[i], plastic.kappa_max[i] = (
            -section.yield_curvature,
            section.yield_curvature,
        )
        for j in range(section.z.size):
            plastic.plastic_strain[i, j] = plastic.peeq[i, j] = 0.0
    plastic.on_tangent[0] = np.uint64(0)


@compiled
def keep_ends_elastic(plastic: PlasticState, grid: BeamGrid) -> None:
    """Let the section at an elastic end never yield: its spring has the share of it (beam.py)."""
    for kind, i in ((grid.left, 2), (grid.right, grid.last)):
        if kind == SPRUNG:
            plastic.kappa_min[i], plastic.kappa_max[i] = -FAR, FAR


@compiled
def curvature(w: Array, now: int, psi: Array | None, grid: BeamGrid, i: Index) -> float:
    """Return kappa in 1/m: w_xx, or psi_x of a beam with its own rotation (timoshenko.py)."""
    if psi is not None:
        return (psi[i] - psi[i - ONE]) / grid.dx
    return (w[now, i - ONE] - 2.0 * w[now, i] + w[now, i + ONE]) * grid.per_dx2


@compiled
def follow_tangents(
    w: Array,
    now: int,
    psi: Array | None,
    plastic: Array,
    M_0: Array,
    on_tangent: Array,
    tangent: Array,
    grid: BeamGrid,
) -> int:
    """Bend the sections on a tangent; return how many have come to its end.

    These get the direction 0 and are left as they are. Runs at every step: see beam.py.
    """
    ended = 0
    for k in range(ONE, on_tangent[0] + ONE):
        i = on_tangent[k]
        kappa = curvature(w, now, psi, grid, i)
        direction, ahead = tangent[i, 0], kappa - tangent[i, 3]
        if ahead * direction >= 0.0 and (tangent[i, 2] - kappa) * direction >= 0.0:
            tangent[i, 3] = kappa
            add_moment(plastic, M_0, i, tangent[i, 1] * ahead, grid)
        else:
            tangent[i, 0] = 0.0
            ended += 1
    return ended


@joined
def leave_tangents(
    beam: BeamState,
    now: int,
    psi: Array | None,
    plastic_state: PlasticState,
    section: FibreSection,
    grid: BeamGrid,
) -> None:
    """Bend the sections that follow_tangents has left."""
    k = np.uint64(1)
    while k <= plastic_state.on_tangent[0]:
        i = plastic_state.on_tangent[k]
        if plastic_state.tangent[i, 0] == 0.0:
            kappa = curvature(beam.w, now, psi, grid, i)
            M_0, plastic_state.kappa_min[i], plastic_state.kappa_max[i] = bend(
                section,
                plastic_state.tangent[i, 3],
                plastic_state.plastic_strain,
                plastic_state.peeq,
                i,
            )
            if plastic_state.kappa_min[i] <= kappa <= plastic_state.kappa_max[i]:
                add_moment(beam.plastic, plastic_state.M_0, i, M_0 - plastic_state.M_0[i], grid)
                plastic_state.on_tangent[k] = plastic_state.on_tangent[plastic_state.on_tangent[0]]
                plastic_state.on_tangent[0] -= ONE
                continue
            _begin_tangent(beam, plastic_state, section, grid, i, kappa)
        k += ONE


@joined
def begin_tangents(
    beam: BeamState,
    now: int,
    psi: Array | None,
    outside: float,
    plastic_state: PlasticState,
    section: FibreSection,
    grid: BeamGrid,
    u: Array,
    w: Array,
) -> int:
    """Bend the `outside` sections that have left their interval.

    Adds what that changes to u and, unless it is empty, to w: a step is mended that has been made
    before. Returns how far from the struck node the last section looked at lies, in spacings.
    """
    away, mid, last, sides = -1, grid.mid, grid.last, 1
    while outside > 0.0 and away < max(mid - 2, last - mid):
        away += 1  # from the struck node, near which they most often are
        for side in range(sides):
            place = mid + away if side else mid - away
            if place < 2 or place > last:
                continue
            i = np.uint64(place)
            kappa = curvature(beam.w, now, psi, grid, i)
            if kappa > plastic_state.kappa_max[i] or kappa < plastic_state.kappa_min[i]:
                outside -= 1.0
                near = (beam.plastic[i - ONE], beam.plastic[i], beam.plastic[i + ONE])
                _yield(beam, plastic_state, section, section.rate, grid, i, kappa)
                # a support does not move
                for j in range(max(i - ONE, TWO), min(i + ONE, np.uint64(last)) + ONE):
                    change = beam.plastic[j] - near[j + ONE - i]
                    u[j] += change
                    if w.size > 0:
                        w[j] += change
        sides = 2 if last > mid else 1
    return away


@compiled
def flow(
    plastic_state: PlasticState,
    section: FibreSection,
    rate: RateLaw,
    i: Index,
    kappa: float,
    dt: float,
) -> float:
    """Let section i flow to kappa (1/m) in the time dt (s); return its new M_0 (N m)."""
    M_0, plastic_state.kappa_min[i], plastic_state.kappa_max[i], work = bend_at_rate(
        section,
        rate,
        kappa,
        plastic_state.flowed[i, 0],
        dt,
        plastic_state.plastic_strain,
        plastic_state.peeq,
        i,
    )
    plastic_state.flowed[i, 0] = kappa
    plastic_state.flowed[i, 1] += work
    return float(M_0)


@joined
def _yield(
    beam: BeamState,
    plastic_state: PlasticState,
    section: FibreSection,
    rate: RateLaw | None,
    grid: BeamGrid,
    i: Index,
    kappa: float,
) -> None:
    """Bend section i out of its elastic interval.

    `rate` is fixed at compile time; None, or a coefficient of 0 disables it.
    """
    if rate is not None and rate.D > 0.0:
        M_0 = flow(plastic_state, section, rate, i, kappa, grid.dt)
        add_moment(beam.plastic, plastic_state.M_0, i, M_0 - plastic_state.M_0[i], grid)
        return
    _begin_tangent(beam, plastic_state, section, grid, i, kappa)
    plastic_state.on_tangent[0] += ONE
    plastic_state.on_tangent[plastic_state.on_tangent[0]] = i


@joined
def _begin_tangent(
    beam: BeamState,
    plastic_state: PlasticState,
    section: FibreSection,
    grid: BeamGrid,
    i: Index,
    kappa: float,
) -> None:
    """Bend section i out of its elastic interval to kappa, where its tangent begins."""
    direction = 1.0 if kappa > plastic_state.kappa_max[i] else -1.0
    M_0, _, _ = bend(section, kappa, plastic_state.plastic_strain, plastic_state.peeq, i)
    add_moment(beam.plastic, plastic_state.M_0, i, M_0 - plastic_state.M_0[i], grid)
    growth, limit = tangent(
        section, kappa, direction, plastic_state.plastic_strain, plastic_state.peeq, i
    )
    line = plastic_state.tangent[i]
    line[0], line[1], line[2], line[3] = direction, growth, limit, kappa
    plastic_state.kappa_min[i], plastic_state.kappa_max[i] = -FAR, FAR


@joined
def catch_up(plastic_state: PlasticState, section: FibreSection) -> None:
    """Bring the fibres of the sections on a tangent up to date."""
    for k in range(ONE, plastic_state.on_tangent[0] + ONE):
        i = plastic_state.on_tangent[k]
        bend(
            section,
            plastic_state.tangent[i, 3],
            plastic_state.plastic_strain,
            plastic_state.peeq,
            i,
        )


@compiled
def plastic_energy(
    plastic_state: PlasticState, section: FibreSection, grid: BeamGrid
) -> tuple[float, float]:
    """Return (stored at zero curvature, dissipated) energy in J, of fibres that are up to date."""
    stored, dissipated = 0.0, 0.0
    peeq = plastic_state.peeq
    for i in range(1, grid.last + 2):  # pinned ends may stretch
        if peeq[i, 0] > 0.0 or peeq[i, peeq.shape[1] - 1] > 0.0:  # an outermost fibre yields first
            stored_i, dissipated_i = plastic_energies(
                section, plastic_state.plastic_strain, plastic_state.peeq, i
            )
            times = copies(grid, i)
            stored += times * stored_i
            dissipated += times * (dissipated_i + plastic_state.flowed[i, 1])
    return stored * grid.dx, dissipated * grid.dx


@summing
def plastic_energies(
    section: FibreSection, plastic_strain: Array, peeq: Array, i: int
) -> tuple[float, float]:
    """Return (stored at zero curvature, dissipated) energy per length of section i, J/m."""
    stored, dissipated, moduli = 0.0, 0.0, section.moduli
    for j in range(section.z.size):
        stored += section.area[j] * stored_energy(plastic_strain[i, j], moduli.E, moduli.H_k)
        lost = dissipated_energy(peeq[i, j], moduli.S_y, moduli.H_i)
        dissipated += section.area[j] * lost
    return stored, dissipated
