"""Two hexahedra, and the nodal forces with which they answer a motion.

With eight integration points and mean dilatation (B-bar): each point has its own deviator; the
dilatation, and with it the mean stress, is one for the whole element, so that plastic flow, which
keeps its volume, does not lock.
Source: J. C. Nagtegaal, D. M. Parks and J. R. Rice, Comput. Methods Appl. Mech. Engng. 4 (1974)
153; T. J. R. Hughes, Int. J. Numer. Meth. Engng. 15 (1980) 1413.

With one integration point: mean strain, and stiffness against hourglassing. Hourglass rates
q_a = h_a - L g_a (four vectors, a = 1 to 4) are what a velocity holds beyond its mean gradient L.
In a frame that turns with the element they strain a brick of half edges a_1, a_2, a_3 by fields
linear in xi, eta and zeta. Assumed of these strains: the shears that bending would bring along
vanish, stresses across bent fibres are free, twist keeps its shear. So a brick bends and twists as
a beam or plate does, and no number has to be chosen. These stresses stay elastic.
Source: the assumed strains follow T. Belytschko and L. P. Bindeman, Comput. Methods Appl. Mech.
Engng. 105 (1993) 225; the projection D. P. Flanagan and T. Belytschko (1981).
"""

import math

from impactlab.fem3d.solver.compiler import Array, compiled, inlined
from impactlab.fem3d.solver.hexahedron import (
    F,
    Shape,
    Tensor,
    V,
    Vector,
    W,
    X,
    add,
    apply,
    combine,
    cross,
    dot,
    gather,
    gradient,
    load,
    load_modes,
    mean_gradient,
    midway,
    nodal,
    plus,
    scatter,
    shape,
    store,
    store_modes,
    times,
    volume,
)
from impactlab.fem3d.solver.material import (
    ALONG,
    PAST_ROWS,
    PEEQ,
    STRESS_ROWS,
    Metal,
    Rate,
    advance,
)

Four = tuple[Vector, Vector, Vector, Vector]

FULL_MEAN, MEAN = 8 * STRESS_ROWS, STRESS_ROWS
"""Row of the mean stress (Pa) in `state`, after the points' deviators."""
_HOURGLASS = MEAN + 1
"""First row of the hourglass forces in N in the element's frame, three of each a."""
FULL_ROWS, ROWS = FULL_MEAN + 1, _HOURGLASS + 12  # rows of `state`
WORK, DISSIPATED, HOURGLASS_WORK = range(3)  # rows of `works`: energies in J

_C, _W, _T = F + 24, F + 45, F + 66
"""First rows in `s` of the modes of position and velocity, and of the modes' forces, 21 each."""
_DONE, _YIELDED = F + 87, F + 90
"""First rows in `s` of a step's works, and of the increments of PEEQ and strain along the beam."""
_ROOT = 1.0 / math.sqrt(3.0)


@compiled
def add_forces(
    pieces: tuple[int, int],
    count: int,
    full: bool,
    metal: Metal,
    rate: Rate | None,
    nodes: Array,
    rows: Array,
    state: Array,
    past: Array,
    works: Array,
    x: Array,
    v: Array,
    dt: float,
    forces: Array,
    s: Array,
) -> None:
    """Take a step's motion into `state`, and add the nodal forces that answer it.

    pieces: the first and the one past the last, see blocks_of. count: of all elements, which the
    last block may repeat. full: with eight integration points. rate: None for a yield stress that
    does not depend on the strain rate. nodes, and the rows of forces that are theirs: (blocks,
    8 W). x: (n, 3) in m, at the step's end; v: (n, 3) in m/s, at its middle; dt in s. state:
    (blocks, rows W), rows FULL_ROWS or ROWS. past: (blocks, points PAST_ROWS W), apart, since
    without hardening only yielding needs it. works: (pieces, 3 W), sums in J by lane. forces:
    (., 3) in N. s: scratch, (SCRATCH W,).
    """
    hardens = metal[5] > 0.0 or metal[6] > 0.0
    for piece in range(pieces[0], pieces[1]):
        first, end = blocks_of(len(state), piece, len(works))
        for block in range(first, end):
            gather(s, nodes[block], x, v)
            if full:
                _answer_full(s, state[block], past[block], dt, metal, hardens, rate)
            else:
                _answer(s, state[block], past[block], dt, metal, hardens, rate)
            for row in range(3):
                for lane in range(min(W, count - block * W)):
                    works[piece, row * W + lane] += s[(_DONE + row) * W + lane]
            scatter(s, rows[block], forces)


@inlined
def blocks_of(blocks: int, piece: int, pieces: int) -> tuple[int, int]:
    """Return the first and the one past the last of the blocks in a piece of a group."""
    return blocks * piece // pieces, blocks * (piece + 1) // pieces


@inlined
def _answer(
    s: Array, state: Array, past: Array, dt: float, metal: Metal, hardens: bool, rate: Rate | None
) -> None:
    """Update a block of elements with one integration point, and store its forces in `s`."""
    yielding = 0
    if hardens:  # for the compiler, a literal: half of the memory is left alone without
        for lane in range(W):
            yielding += _element(s, state, past, lane, dt, metal, True, rate)
    else:
        for lane in range(W):
            yielding += _element(s, state, past, lane, dt, metal, False, rate)
    _yield(s, past, 0, yielding)


@inlined
def _answer_full(
    s: Array, state: Array, past: Array, dt: float, metal: Metal, hardens: bool, rate: Rate | None
) -> None:
    """Update a block of fully integrated elements, and store its forces in `s`."""
    for lane in range(W):
        _begin(s, state, lane, dt, metal)
    for corner in range(8):
        xi = _ROOT * (2 * (corner & 1) - 1)
        eta = _ROOT * ((corner & 2) - 1)
        zeta = _ROOT * ((corner >> 1 & 2) - 1)
        place, yielding = (xi, eta, zeta), 0
        if hardens:
            for lane in range(W):
                yielding += _point(s, state, past, corner, lane, place, dt, metal, True, rate)
        else:
            for lane in range(W):
                yielding += _point(s, state, past, corner, lane, place, dt, metal, False, rate)
        _yield(s, past, corner, yielding)
    for lane in range(W):
        nodal(s, lane, load_modes(s, _T, lane))


@inlined
def _yield(s: Array, past: Array, point: int, yielding: int) -> None:
    """Add the increments to a point's PEEQ and strain along the beam, if a lane is yielding."""
    row = PAST_ROWS * point
    if yielding > 0:
        for lane in range(W):
            past[(row + PEEQ) * W + lane] += s[_YIELDED * W + lane]
            past[(row + ALONG) * W + lane] += s[(_YIELDED + 1) * W + lane]


@inlined
def _dilate(
    state: Array, row: int, lane: int, L: Tensor, dt: float, metal: Metal
) -> tuple[float, float, float]:
    """Return the dilation in a step, and the mean stress before and after it, which is stored."""
    dilation = dt * (L[0][0] + L[1][1] + L[2][2])
    before = state[row * W + lane]
    mean = before + metal[3] * dilation
    state[row * W + lane] = mean
    return dilation, before, mean


@inlined
def _element(
    s: Array,
    state: Array,
    past: Array,
    lane: int,
    dt: float,
    metal: Metal,
    hardens: bool,
    rate: Rate | None,
) -> int:
    """Update an element's stresses, and store its nodal forces in `s`; return whether it yields."""
    c, w = shape(s, X, lane), shape(s, V, lane)
    B = gradient(c)
    size = volume(c, B)
    L = mean_gradient(w, B, size)
    Q, work = hourglass(state, lane, c, w, L, size, dt, metal)
    s[(_DONE + HOURGLASS_WORK) * W + lane] = work
    L = midway(L, dt)
    S, work, dissipated, dp, along = advance(state, past, 0, lane, L, dt, metal, hardens, rate)
    dilation, before, mean = _dilate(state, MEAN, lane, L, dt, metal)
    s[(_DONE + WORK) * W + lane] = size * (work + 0.5 * (before + mean) * dilation)
    s[(_DONE + DISSIPATED) * W + lane] = size * dissipated
    share, g = 1.0 / size, (c[3], c[4], c[5], c[6])
    T = (
        _row((S[0] + mean, S[5], S[4]), g, Q, 0, share),
        _row((S[5], S[1] + mean, S[3]), g, Q, 1, share),
        _row((S[4], S[3], S[2] + mean), g, Q, 2, share),
    )
    forces = (
        times(0.125, apply(T, B[0])),
        times(0.125, apply(T, B[1])),
        times(0.125, apply(T, B[2])),
        times(0.125, plus(apply(T, B[3]), 1.0, Q[0])),
        times(0.125, plus(apply(T, B[4]), 1.0, Q[1])),
        times(0.125, plus(apply(T, B[5]), 1.0, Q[2])),
        times(0.125, Q[3]),
    )
    nodal(s, lane, forces)
    return _raise(s, lane, dp, along)


@inlined
def _raise(s: Array, lane: int, dp: float, along: float) -> int:
    """Store increments of PEEQ and strain along the beam; return whether there are any."""
    s[_YIELDED * W + lane], s[(_YIELDED + 1) * W + lane] = dp, along
    return int(dp != 0.0)


@inlined
def _row(stress: Vector, g: Four, Q: Four, axis: int, share: float) -> Vector:
    """Return a row of the stress, minus the hourglass forces' part in the mean gradient."""
    product = combine((g[0], g[1], g[2]), (Q[0][axis], Q[1][axis], Q[2][axis]))
    return plus(stress, -share, plus(product, Q[3][axis], g[3]))


@inlined
def hourglass(
    state: Array, lane: int, c: Shape, w: Shape, L: Tensor, V: float, dt: float, metal: Metal
) -> tuple[Four, float]:
    """Return the four hourglass forces (N) at a step's end, and their work (J) in it.

    L: dv/dx at the step's end. The forces in `state` are updated.
    """
    row = _HOURGLASS
    # A frame of unit vectors: along c_1, in the plane of c_1 and c_2, across it.
    along, across = times(1.0 / math.sqrt(dot(c[0], c[0])), c[0]), cross(c[0], c[1])
    across = times(1.0 / math.sqrt(dot(across, across)), across)
    e = (along, cross(across, along), across)
    half = (dot(e[0], c[0]), dot(e[1], c[1]), dot(e[2], c[2]))
    q1, q2 = _rate(e, c[3], w[3], L), _rate(e, c[4], w[4], L)
    q3, q4 = _rate(e, c[5], w[5], L), _rate(e, c[6], w[6], L)
    p1, p2, p3, p4 = _stiffness((q1, q2, q3, q4), half, V * dt, metal)
    Q1, power1 = _raised(state, row, lane, p1, q1)
    Q2, power2 = _raised(state, row + 3, lane, p2, q2)
    Q3, power3 = _raised(state, row + 6, lane, p3, q3)
    Q4, power4 = _raised(state, row + 9, lane, p4, q4)
    work = dt * ((power1 + power2) + (power3 + power4))
    return (combine(e, Q1), combine(e, Q2), combine(e, Q3), combine(e, Q4)), work


@inlined
def _rate(e: Tensor, g: Vector, h: Vector, L: Tensor) -> Vector:
    """Return h - L g in the frame, in m/s."""
    return apply(e, plus(h, -1.0, apply(L, g)))


@inlined
def _stiffness(q: Four, half: Vector, V: float, metal: Metal) -> Four:
    """Return the forces against hourglass motions q: brick means of stress times strain."""
    q1, q2, q3, q4 = q
    E, nu, G = metal[0], metal[1], metal[2]
    i1, i2, i3 = 1.0 / half[0], 1.0 / half[1], 1.0 / half[2]
    plate, shear, fibre = V * E / (3.0 * (1.0 - nu * nu)), V * G / 3.0, V * E / 9.0
    y3, z2 = _pair(plate, nu, q3[1] * i2, q2[2] * i3)  # varies with xi
    x3, z1 = _pair(plate, nu, q3[0] * i1, q1[2] * i3)  # with eta
    x2, y1 = _pair(plate, nu, q2[0] * i1, q1[1] * i2)  # with zeta
    t1 = shear * (q3[2] * i2 + q2[1] * i3)
    t2 = shear * (q3[2] * i1 + q1[0] * i3)
    t3 = shear * (q1[0] * i2 + q2[1] * i1)
    return (
        (t2 * i3 + t3 * i2, y1 * i2, z1 * i3),
        (x2 * i1, t1 * i3 + t3 * i1, z2 * i3),
        (x3 * i1, y3 * i2, t1 * i2 + t2 * i1),
        (fibre * i1 * i1 * q4[0], fibre * i2 * i2 * q4[1], fibre * i3 * i3 * q4[2]),
    )


@inlined
def _pair(plate: float, nu: float, first: float, second: float) -> tuple[float, float]:
    """Return stresses of two normal strains that vary alike, the third direction free of stress."""
    return plate * (first + nu * second), plate * (second + nu * first)


@inlined
def _raised(state: Array, row: int, lane: int, rise: Vector, q: Vector) -> tuple[Vector, float]:
    """Raise three forces; return them and the power of their mean in the step."""
    before = load(state, row, lane)
    after = plus(before, 1.0, rise)
    store(state, row, lane, after)
    return after, dot(plus(before, 0.5, rise), q)


@inlined
def _begin(s: Array, state: Array, lane: int, dt: float, metal: Metal) -> None:
    """Store the modes of the motion in `s`; update the mean stress, its work and its forces."""
    c, w = shape(s, X, lane), shape(s, V, lane)
    store_modes(s, _C, lane, c)
    store_modes(s, _W, lane, w)
    B = gradient(c)
    size = volume(c, B)
    L = midway(mean_gradient(w, B, size), dt)
    dilation, before, mean = _dilate(state, FULL_MEAN, lane, L, dt, metal)
    s[(_DONE + WORK) * W + lane] = size * 0.5 * (before + mean) * dilation
    s[(_DONE + DISSIPATED) * W + lane] = 0.0
    s[(_DONE + HOURGLASS_WORK) * W + lane] = 0.0
    for mode in range(6):
        store(s, _T + 3 * mode, lane, times(0.125 * mean, B[mode]))
    store(s, _T + 18, lane, (0.0, 0.0, 0.0))


@inlined
def _point(
    s: Array,
    state: Array,
    past: Array,
    point: int,
    lane: int,
    place: Vector,
    dt: float,
    metal: Metal,
    hardens: bool,
    rate: Rate | None,
) -> int:
    """Update an integration point's deviator and its work; add its share to the modes' forces.

    Returns whether it yields.
    """
    xi, eta, zeta = place
    r, v = _slopes(load_modes(s, _C, lane), place), _slopes(load_modes(s, _W, lane), place)
    C = (cross(r[1], r[2]), cross(r[2], r[0]), cross(r[0], r[1]))  # cofactors of dx/dxi
    size = dot(r[0], C[0])
    share = 1.0 / size
    gradient = (
        times(share, combine(C, (v[0][0], v[1][0], v[2][0]))),
        times(share, combine(C, (v[0][1], v[1][1], v[2][1]))),
        times(share, combine(C, (v[0][2], v[1][2], v[2][2]))),
    )
    L = midway(gradient, dt)
    S, work, dissipated, dp, along = advance(state, past, point, lane, L, dt, metal, hardens, rate)
    s[(_DONE + WORK) * W + lane] += size * work
    s[(_DONE + DISSIPATED) * W + lane] += size * dissipated
    T = ((S[0], S[5], S[4]), (S[5], S[1], S[3]), (S[4], S[3], S[2]))
    # Forces that work on the derivatives by xi, eta and zeta, and those of the modes.
    t1, t2 = times(0.125, apply(T, C[0])), times(0.125, apply(T, C[1]))
    t3 = times(0.125, apply(T, C[2]))
    f1, f2, f3, f4, f5, f6, f7 = load_modes(s, _T, lane)
    forces = (
        add(f1, t1),
        add(f2, t2),
        add(f3, t3),
        plus(plus(f4, zeta, t2), eta, t3),
        plus(plus(f5, zeta, t1), xi, t3),
        plus(plus(f6, eta, t1), xi, t2),
        plus(plus(plus(f7, eta * zeta, t1), zeta * xi, t2), xi * eta, t3),
    )
    store_modes(s, _T, lane, forces)
    return _raise(s, lane, dp, along)


@inlined
def _slopes(c: Shape, place: Vector) -> Tensor:
    """Return derivatives by xi, eta and zeta, at a point."""
    xi, eta, zeta = place
    c1, c2, c3, g1, g2, g3, g4 = c
    return (
        plus(plus(plus(c1, zeta, g2), eta, g3), eta * zeta, g4),
        plus(plus(plus(c2, zeta, g1), xi, g3), zeta * xi, g4),
        plus(plus(plus(c3, eta, g1), xi, g2), xi * eta, g4),
    )
