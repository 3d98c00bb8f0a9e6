"""The beam at rest after a strike: its static shape with the plastic strains held.

Without a load the moment is linear along the beam and the shear force Q constant, unless a
foundation of the stiffness k per length holds the beam, and

    M_x = Q,   Q_x = k w,   kappa = (M_0 - M)/EI,   w_x = psi + Q/(k G A)

are summed from the left end on (Q/(k G A) = 0 and psi = w_x, half-way between nodes, of
Euler-Bernoulli's beam: the equations are those of its differences, see beam.py). Each end leaves
two of its four quantities free; those of the left end follow from the two conditions of the right
one. Pinned beams and cantilevers have no moment at rest, so that kappa = M_0/EI. On a foundation
errors of the sum grow as exp(L (k/(4 EI))^(1/4)), of which model/case_table.py allows exp(20).

A section that rest would bend beyond its elastic interval yields, and the shape is sought anew: by
turns, which only lowers the energy. Since a beam swings about its rest, that is rare.
"""

from impactlab.solver.beam import (
    CLAMPED,
    PINNED,
    SYMMETRIC,
    BeamGrid,
    BeamState,
    add_moment,
    mirror,
)
from impactlab.solver.fibre_plasticity import PlasticState, curvature
from impactlab.solver.jit import compiled
from impactlab.solver.section import FibreSection, bend
from impactlab.solver.types import ONE, Array

ROUNDS = 200
"""The most rounds of sections that yield at rest."""
_SMALL = 1e-9
"""Of the yield curvature: beyond its interval by less, a section has not yielded."""


@compiled
def yields_at_rest(plastic: PlasticState, section: FibreSection, i: int, kappa: float) -> bool:
    """Return whether kappa (1/m) is outside the elastic interval of section i."""
    small = _SMALL * section.yield_curvature
    return bool(kappa > plastic.kappa_max[i] + small or kappa < plastic.kappa_min[i] - small)


@compiled
def end_tangents(
    beam: BeamState, plastic: PlasticState, section: FibreSection, grid: BeamGrid
) -> None:
    """Bring the sections on a tangent up to date, and give them elastic intervals."""
    for k in range(ONE, plastic.on_tangent[0] + ONE):
        i = plastic.on_tangent[k]
        M_0, plastic.kappa_min[i], plastic.kappa_max[i] = bend(
            section, plastic.tangent[i, 3], plastic.plastic_strain, plastic.peeq, i
        )
        add_moment(beam.plastic, plastic.M_0, i, M_0 - plastic.M_0[i], grid)
    plastic.on_tangent[0] = 0


@compiled
def _end(
    grid: BeamGrid, kind: int, turn: float, lift: float, EI: float, bed: float
) -> tuple[float, float]:
    """Return stiffnesses of an end: of the first half spacing against the slope there (N m).

    And against deflection (N/m), that of the foundation under it included, -1 where it has none.
    """
    holds = 1.0 if kind in (CLAMPED, SYMMETRIC) else turn
    if kind in (CLAMPED, PINNED):
        return 2.0 * EI / grid.dx * holds, -1.0
    spring = 0.0 if kind == SYMMETRIC else 0.5 * EI * lift / grid.dx**3
    return 2.0 * EI / grid.dx * holds, spring + 0.5 * grid.dx * bed


@compiled
def _shoot(
    w: Array,
    psi: Array,
    M_0: Array,
    share: float,
    start: tuple[float, float],
    EI: float,
    softness: float,
    grid: BeamGrid,
    bed: float,
) -> tuple[float, float]:
    """Set w (m) and psi from the left end on; return what both conditions of the right one miss.

    share: of M_0 that counts. start: psi beside the left end, and its deflection (m) where that is
    free, else the shear force (N). softness: 1/(k G A). bed: of the foundation (N/m2).
    """
    first, stop, dx = grid.first - 1, grid.stop, grid.dx
    turn, spring = _end(grid, grid.left, grid.turn_left, grid.lift_left, EI, bed)
    slope, w[first] = start[0], start[1] if spring >= 0.0 else 0.0
    Q = spring * w[first] if spring >= 0.0 else start[1]
    M = share * M_0[first] - turn * slope
    psi[first], w[first + 1] = slope, w[first] + dx * (slope + softness * Q)
    for i in range(first + 1, stop):
        M += dx * Q
        slope += dx * (share * M_0[i] - M) / EI
        Q += dx * bed * w[i]
        psi[i], w[i + 1] = slope, w[i] + dx * (slope + softness * Q)
    turn, spring = _end(grid, grid.right, grid.turn_right, grid.lift_right, EI, bed)
    missed = w[stop] if spring < 0.0 else Q + spring * w[stop]
    return M + dx * Q - share * M_0[stop] - turn * slope, missed


@compiled
def static_shape(
    w: Array, psi: Array, M_0: Array, EI: float, softness: float, grid: BeamGrid, bed: float
) -> float:
    """Set the deflection w (m) and psi at rest under the moments M_0 (N m); return Q (N).

    That is the first one from the left. softness: 1/(k G A), 0 without shear. bed: stiffness of the
    foundation (N/m2).
    """
    a, b = _shoot(w, psi, M_0, 1.0, (0.0, 0.0), EI, softness, grid, bed)
    a_turn, b_turn = _shoot(w, psi, M_0, 0.0, (1.0, 0.0), EI, softness, grid, bed)
    a_push, b_push = _shoot(w, psi, M_0, 0.0, (0.0, 1.0), EI, softness, grid, bed)
    det = a_turn * b_push - a_push * b_turn
    start = (a_push * b - b_push * a) / det, (b_turn * a - a_turn * b) / det
    _shoot(w, psi, M_0, 1.0, start, EI, softness, grid, bed)
    _, spring = _end(grid, grid.left, grid.turn_left, grid.lift_left, EI, bed)
    return spring * start[1] if spring >= 0.0 else start[1]


@compiled
def rest_nodes(beam: BeamState, grid: BeamGrid) -> None:
    """Make beam.w[0] that of both steps, and nothing move."""
    for i in range(beam.u.size):
        beam.w[1, i] = beam.w[0, i]
        beam.u[i] = beam.du[i] = 0.0
    mirror(beam.w, 1, beam.u, grid)
    mirror(beam.w, 0, beam.u, grid)


@compiled
def yield_on(
    beam: BeamState,
    psi: Array | None,
    plastic: PlasticState,
    section: FibreSection,
    grid: BeamGrid,
) -> bool:
    """Bend the sections that are outside their elastic interval at rest; return whether any is."""
    outside = False
    for i in range(2, grid.last + 1):
        kappa = curvature(beam.w, 0, psi, grid, i)
        plastic.flowed[i, 0] = kappa
        if yields_at_rest(plastic, section, i, kappa):
            M_0, plastic.kappa_min[i], plastic.kappa_max[i] = bend(
                section, kappa, plastic.plastic_strain, plastic.peeq, i
            )
            add_moment(beam.plastic, plastic.M_0, i, M_0 - plastic.M_0[i], grid)
            outside = True
    return outside


@compiled
def settle(
    beam: BeamState, plastic: PlasticState, section: FibreSection, grid: BeamGrid, bed: float
) -> None:
    """Put Euler-Bernoulli's beam to rest. bed: stiffness of the foundation (N/m2)."""
    end_tangents(beam, plastic, section, grid)
    for _ in range(ROUNDS):
        static_shape(beam.w[0], beam.u, plastic.M_0, section.stiffness, 0.0, grid, bed)
        rest_nodes(beam, grid)
        if not yield_on(beam, None, plastic, section, grid):
            break
