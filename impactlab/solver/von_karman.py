"""The beam that stretches as it deflects: von Karman's strains, moderate rotations.

With the axial displacement u, the strain of the axis e and the axial force N,

    e = u_x + w_x^2/2, strain(z) = e - z w_xx,
    rho A u_tt = N_x, rho A w_tt = M_xx + (N w_x)_x + p.

Fibres over the whole depth yield under stretching and bending together. w, e, M and N are at nodes,
u and the slope s half-way to the next one, so that with

    e_i = (u_i - u_i-1)/dx + (s_i^2 + s_i-1^2)/4

axial force and moment of a node do the work of the strains of one section, and no pattern of u is
without strain. Forces are derivatives of the energy dx sum_i W(e_i, kappa_i): that of w_i is the
difference of P = s (N_i + N_i+1)/2 beside those of the moments. The sum of energies is conserved by
the semi-discrete beam. An end that is pinned or clamped holds the axis: u is odd and s^2 even about
it, as at mid-span of a half beam. So does an elastic end with a spring against deflection;
half a spacing beside it stays elastic. At a roller, at a free end and at one with a spring against
rotation alone N is 0. Nothing holds a beam with two of these along its axis, and nothing pushes it
there: its axial momentum stays 0.

While no fibre yields, N = N_0 + EA e and M = M_0 - EI kappa. A section remembers N_0, M_0, the
strains at which its fibres were looked at last, and by how much one of them may be strained from
there before it yields.

Source: T. von Karman, Encyklopaedie der mathematischen Wissenschaften IV/4 (1910); for beams S.
Woinowsky-Krieger, J. Appl. Mech. 17 (1950) 35 (both recalled).
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver import euler_bernoulli
from impactlab.solver.beam import (
    FREE,
    SPRUNG,
    SYMMETRIC,
    BeamGrid,
    BeamState,
    copies,
    end_springs,
    is_end,
    mirror,
    push_nodes,
)
from impactlab.solver.contact_patch import spread_over_nodes
from impactlab.solver.fibre_plasticity import PlasticState, plastic_energy
from impactlab.solver.jit import allocating, compiled, inlined, summing, vectorised
from impactlab.solver.resisted_pair import (
    PairResistance,
    make_resistance,
    resist,
    resisted_energy,
    rest_resistance,
    take_work,
)
from impactlab.solver.resisted_stretch import drag_stretch
from impactlab.solver.section import (
    FibreSection,
    cut_whole_section,
    make_whole_room,
    strain_fibres,
)
from impactlab.solver.settle import ROUNDS, rest_nodes
from impactlab.solver.settle_stretch import rest_remarks, static_axis, static_stretch
from impactlab.solver.state import BeamModel, State
from impactlab.solver.strain_rate import RateLaw
from impactlab.solver.types import ONE, Array, Record

_SMALL = 1e-9
"""Of the yield strain: sections that rest changes by less have not yielded."""


class Stretch(NamedTuple):
    """The state of a von Karman beam besides BeamState; all arrays (last + 3,) but for `memory`.

    stiffness: EA (N). start, stop: the sections with an axial force, from start to before stop.
    held: whether the axis is held at the left end and at the right one. u: axial displacement, v =
    dt u_t its increment, dv the last change of that (m), P = N w_x (N): half-way from node i to
    i + 1 at index i. e, kappa (1/m), N (N), M (N m): at nodes, where the step began; N_0 (N).
    memory: e and kappa (1/m) when the fibres of a node were looked at last, and the strain that no
    fibre yields by from there, (last + 3, 3). resistance: damping and foundation. bands: room for
    the beam at rest, (5, last + 3).
    """

    stiffness: float
    start: int
    stop: int
    held: tuple[bool, bool]
    u: Array
    v: Array
    dv: Array
    P: Array
    e: Array
    kappa: Array
    N: Array
    M: Array
    N_0: Array
    memory: Array
    resistance: PairResistance
    bands: Array


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Stretch:
    """Return the state at rest."""
    size, stiffness = grid.last + 3, 0.0
    for j in range(section.area.size):
        stiffness += section.moduli.E * section.area[j]
    left = case.axis_held_left > 0
    right = case.axis_held_right > 0 or grid.right == SYMMETRIC
    memory = np.zeros((size, 3))
    memory[:, 2] = section.moduli.S_y / section.moduli.E
    return Stretch(
        stiffness,
        grid.first - 1 if left and grid.left != SPRUNG else grid.first,
        grid.stop + 1 if right and grid.right != SPRUNG else grid.stop,
        (left, right),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        memory,
        make_resistance(case, section, grid),
        np.zeros((5, size)),
    )


@inlined
def _strain_sections(
    section: FibreSection,
    grid: BeamGrid,
    beam: BeamState,
    plastic: PlasticState,
    stretch: Stretch,
    now: int,
    rate: RateLaw | None,
) -> float:
    """Set forces and moments of the sections, and moments beyond the ends; return 1/dx."""
    u, w, N, M = stretch.u, beam.w, stretch.N, stretch.M
    left, right, last = grid.first - 1, grid.stop, grid.last
    if stretch.held[0]:
        u[left - 1] = -u[left]
    if stretch.held[1]:
        u[right] = -u[right - 1]
    per_dx, edge = 1.0 / grid.dx, section.z[0]
    outside = _strain(w, now, stretch, plastic.M_0, section.stiffness, edge, per_dx)
    if outside > 0.0:
        _look_at_fibres(stretch, plastic, section, rate, grid.dt)
    if grid.left == FREE:
        M[1] = M[3]
    if grid.right == FREE or grid.right == SYMMETRIC:
        M[last + 1], N[last + 1] = M[last - 1], N[last - 1]
    if grid.left == SPRUNG or grid.right == SPRUNG:
        _strain_springs(w, now, stretch, section.stiffness, grid)
    return per_dx


@inlined
def _step(state: State, now: int, F: float) -> None:
    _, section, grid, beam, plastic, stretch = state
    w, M, P, resistance = beam.w, stretch.M, stretch.P, stretch.resistance
    left, right, last = grid.first - 1, grid.stop, grid.last
    if resistance.acts:
        take_work(beam, stretch.v, stretch.dv, grid.mu, resistance, grid)
        if resistance.lag > 0.0:
            v, EA = stretch.v, stretch.stiffness
            drag_stretch(w, now, beam.u, v, P, EA, stretch.held, resistance, grid)
    per_dx = _strain_sections(section, grid, beam, plastic, stretch, now, section.rate)
    _stretch(w, now, stretch, grid.push, per_dx, left, right)
    P[left - 1], P[right] = -P[left], -P[right - 1]
    mid = grid.mid
    _shift(w, now, beam.u, beam.du, M, P, grid.push, per_dx, F / copies(grid, mid), mid, 2)
    if last > mid:
        _shift(w, now, beam.u, beam.du, M, P, grid.push, per_dx, 0.0, last, mid + 1)
    if resistance.acts:
        resist(beam, now, stretch.u, stretch.v, stretch.dv, resistance, grid)
    mirror(w, now, beam.u, grid)


@vectorised
def _strain(
    w: Array, now: int, stretch: Stretch, M_0: Array, EI: float, edge: float, per_dx: float
) -> float:
    """Set strains, forces and moments of the sections; return how many have to be looked at.

    edge: of the section, its distance from the axis (m).
    """
    u, e, kappa, memory = stretch.u, stretch.e, stretch.kappa, stretch.memory
    N, M, N_0, EA = stretch.N, stretch.M, stretch.N_0, stretch.stiffness
    outside = 0.0
    for i in range(np.uint64(stretch.start), np.uint64(stretch.stop)):
        before, after = (
            (w[now, i] - w[now, i - ONE]) * per_dx,
            (w[now, i + ONE] - w[now, i]) * per_dx,
        )
        e[i] = (u[i] - u[i - ONE]) * per_dx + 0.25 * (before * before + after * after)
        kappa[i] = (after - before) * per_dx
        strained = abs(e[i] - memory[i, 0]) + edge * abs(kappa[i] - memory[i, 1])
        outside += 1.0 if strained > memory[i, 2] else 0.0
        N[i] = N_0[i] + EA * e[i]
        M[i] = M_0[i] - EI * kappa[i]
    return outside


@compiled
def _strain_springs(w: Array, now: int, stretch: Stretch, EI: float, grid: BeamGrid) -> None:
    """Set strains, force and moment of elastic ends, and the moment beyond them."""
    N, M, dx = stretch.N, stretch.M, grid.dx
    for kind, end, inward, half, turn, lift, held in (
        (grid.left, 2, 1, 2, grid.turn_left, grid.lift_left, stretch.held[0]),
        (
            grid.right,
            grid.last,
            -1,
            grid.last - 1,
            grid.turn_right,
            grid.lift_right,
            stretch.held[1],
        ),
    ):
        if kind == SPRUNG:
            slope = (w[now, end + inward] - w[now, end]) / dx
            strain = 2.0 * inward * stretch.u[half] / dx + 0.5 * slope * slope
            N[end] = stretch.stiffness * strain if held else 0.0
            M[end] = -2.0 * EI * turn * slope / dx
            M[end - inward] = M[end + inward] - lift * EI / dx**2 * w[now, end]


@compiled
def _look_at_fibres(
    stretch: Stretch, plastic: PlasticState, section: FibreSection, rate: RateLaw | None, dt: float
) -> None:
    """Take the fibres of the sections where one may yield to the strains of these."""
    e, kappa, memory, edge = stretch.e, stretch.kappa, stretch.memory, section.z[0]
    for place in range(stretch.start, stretch.stop):
        i = np.uint64(place)
        if abs(e[i] - memory[i, 0]) + edge * abs(kappa[i] - memory[i, 1]) > memory[i, 2]:
            before = memory[i, 0], memory[i, 1]
            N_0, M_0, room, work = strain_fibres(
                section, rate, e[i], kappa[i], before, dt, plastic.plastic_strain, plastic.peeq, i
            )
            stretch.N[i] += N_0 - stretch.N_0[i]
            stretch.M[i] += M_0 - plastic.M_0[i]
            stretch.N_0[i], plastic.M_0[i] = N_0, M_0
            memory[i, 0], memory[i, 1], memory[i, 2] = e[i], kappa[i], room
            plastic.flowed[i, 1] += work


@vectorised
def _stretch(
    w: Array, now: int, stretch: Stretch, push: float, per_dx: float, start: int, stop: int
) -> None:
    """Set P and move the axial displacement; start, stop: the ends. push = dt^2/(rho A dx)."""
    u, v, dv, N, P = stretch.u, stretch.v, stretch.dv, stretch.N, stretch.P
    for i in range(np.uint64(start), np.uint64(stop)):
        P[i] = 0.5 * (N[i] + N[i + ONE]) * (w[now, i + ONE] - w[now, i]) * per_dx
        dv[i] = push * (N[i + ONE] - N[i])
        v[i] += dv[i]
        u[i] += v[i]


@vectorised
def _shift(
    w: Array,
    now: int,
    u: Array,
    du: Array,
    M: Array,
    P: Array,
    push: float,
    per_dx: float,
    F: float,
    mid: int,
    start: int,
) -> None:
    """Move the deflection from `start` to `mid`, where F acts; push = dt^2/(rho A dx)."""
    after = 1 - now
    for i in range(np.uint64(start), np.uint64(mid + 1)):
        bent = (M[i - ONE] - 2.0 * M[i] + M[i + ONE]) * per_dx
        du[i] = push * (bent + P[i] - P[i - ONE])
    du[mid] += push * F
    for i in range(np.uint64(start), np.uint64(mid + 1)):
        u[i] += du[i]
        w[after, i] = w[now, i] + u[i]


@summing
def _elastic_energy(
    beam: BeamState, stretch: Stretch, M_0: Array, EI: float, grid: BeamGrid
) -> float:
    """Return the beam's energy in J after a step, at its beginning, without plastic strains'."""
    u, du, v, dv, N, M = beam.u, beam.du, stretch.v, stretch.dv, stretch.N, stretch.M
    moved, strained = 0.0, 0.0
    for i in range(2, grid.last + 1):
        share = 0.5 if is_end(grid, i) else 1.0
        moved += share * u[i] * (u[i] - du[i])
    for i in range(grid.first - 1, grid.stop):
        moved += v[i] * (v[i] - dv[i])
    for i in range(stretch.start, stretch.stop):
        share = 0.5 if is_end(grid, i) else 1.0
        pulled = (N[i] * N[i] - stretch.N_0[i] * stretch.N_0[i]) / stretch.stiffness
        strained += share * (pulled + (M[i] * M[i] - M_0[i] * M_0[i]) / EI)
    return 0.5 * grid.copies * grid.dx * (grid.mu * moved / grid.dt**2 + strained)


@compiled
def _spring_energy(beam: BeamState, now: int, stretch: Stretch, EI: float, grid: BeamGrid) -> float:
    """Return the energy (J) of elastic ends, with half a spacing beside them."""
    total, w, N, dx = 0.0, beam.w, stretch.N, grid.dx
    for kind, end, inward, turn, lift in (
        (grid.left, 2, 1, grid.turn_left, grid.lift_left),
        (grid.right, grid.last, -1, grid.turn_right, grid.lift_right),
    ):
        if kind == SPRUNG:
            squares = end_springs(w[now, end], w[now, end + inward], turn, lift)
            total += 0.5 * EI / dx**3 * squares + 0.25 * dx * N[end] * N[end] / stretch.stiffness
    return grid.copies * total


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    _, section, grid, beam, plastic, stretch = state
    stored, dissipated = plastic_energy(plastic, section, grid)
    EI = section.stiffness
    elastic = _elastic_energy(beam, stretch, plastic.M_0, EI, grid)
    total = stored + dissipated + elastic
    if grid.left == SPRUNG or grid.right == SPRUNG:
        total += _spring_energy(beam, now, stretch, EI, grid)
    resistance = stretch.resistance
    if resistance.acts:
        total += resisted_energy(beam, now, stretch.v, stretch.dv, grid.mu, resistance, grid)
    return total


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    share = 1.0 + state.extra.resistance.h
    ahead, _, _ = spread_over_nodes(state.beam, state.grid, now, F / share, a)
    return ahead, 0.0


@compiled
def _settle(state: State) -> None:
    """Put the beam to rest; sections that this strains too far yield, by turns."""
    _, section, grid, beam, plastic, stretch = state
    EI, EA, held, edge = section.stiffness, stretch.stiffness, stretch.held, section.z[0]
    bands, M_0, N_0 = stretch.bands, plastic.M_0, stretch.N_0
    bed = stretch.resistance.bed * grid.mu / grid.dt**2
    rest_resistance(stretch.resistance)
    for i in range(stretch.v.size):
        stretch.v[i] = stretch.dv[i] = 0.0
    small = _SMALL * section.moduli.S_y / section.moduli.E
    for _ in range(ROUNDS):
        N = static_stretch(beam.w[0], bands, M_0, N_0, EI, EA, bed, held[0] and held[1], grid)
        static_axis(stretch.u, beam.w[0], N, N_0, EA, held, grid)
        rest_nodes(beam, grid)
        for i in range(M_0.size):
            bands[4, i] = M_0[i]
        _strain_sections(section, grid, beam, plastic, stretch, 0, None)
        change = 0.0
        for i in range(stretch.start, stretch.stop):
            change = max(change, abs(stretch.N[i] - N) / EA)
            change = max(change, edge * abs(M_0[i] - bands[4, i]) / EI)
        if change < small:
            break


@compiled
def _push(state: State, now: int, nodes: Array, forces: Array) -> float:
    share = 1.0 / (1.0 + state.extra.resistance.h)
    push_nodes(state.beam, state.grid, now, nodes, forces, share)
    return 0.0


MODEL = BeamModel(
    _make,
    _step,
    euler_bernoulli.MODEL.curvature,
    _energy,
    euler_bernoulli.deflected,
    _spread,
    settle=_settle,
    rest_remarks=rest_remarks,
    section=(make_whole_room, cut_whole_section),
    push=_push,
)
