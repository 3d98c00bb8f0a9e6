"""The Timoshenko beam whose section bends across its width, with the inertia of that.

A bent beam curves across its width, by -nu kappa (Saint-Venant). A blow at mid-width bends the
section across, too, and both take the time of a wave across the width, which on a wide beam is
that of the contact. The section's lowest mode that bends it across has the amplitude s(x, t), a
curvature. On a thin plate it is nearly

    w(x, y) = w + s (y^2 - B^2/12)/2.

With its inertia m, its stiffness D_s, the twist T of its slope along the beam and the lever l, by
which s lifts the struck face at mid-width, per length

    2 U = EI kappa^2 + D_s (s + nu kappa)^2 + T s_x^2,   2 K = m s_t^2

beside the beam's own shear and inertias, so that, with F over the middle of the width,

    m s_tt = T s_xx - D_s (s + nu kappa) - l F delta(x - L/2),
    M = M_0 - EI kappa - nu D_s (s + nu kappa).

Waves as long as the beam leave s = -nu kappa, and the beam's EI. m, D_s and l are those of the
elastic section's mode at wave number 0, with shear, rotary inertia and change of depth; T gives its
frequency where half a wave is as long as the width (model/contact_compliance.py has the tables). A
thin plate's parabola would have D_s = D B, D = E H^3/(12 (1 - nu^2)), m = rho H B^5/720, l = B^2/24
and T = (1 - nu) D B^3/6. Left out: the section's higher modes, which are as fast as the contact is
stiff; what they do in statics is in the local compliance. s = 0 at the supports; no end is free
(model/contact_compliance.py).

Against the elastic section itself, under a sine's power 1.5 as long as the contact: the struck face
errs by 0.12, 0.03 and 0.12 % on beams with H/B = 0.25, 0.46 and 0.67 (the thin plate: 1.2, 0.25 and
0.34 %), the mean deflection from then on by 0.06, 0.16 and 0.3 % (without s: 0.8, 0.6 and 0.6 %).

Source: the plate's energy, Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells (1959),
eq. 47; the free strip's frequency, the same as a free beam's, Rayleigh, Theory of Sound, art. 173
(both recalled).
"""

import math
from typing import NamedTuple

import numpy as np

from impactlab.solver import timoshenko
from impactlab.solver.beam import CLAMPED, SYMMETRIC, BeamGrid, push_nodes
from impactlab.solver.contact.axis_lift import axis_lift
from impactlab.solver.contact_patch import spread_over_nodes
from impactlab.solver.euler_bernoulli import deflected
from impactlab.solver.fibre_plasticity import curvature, plastic_energy
from impactlab.solver.jit import allocating, compiled, inlined, summing, vectorised
from impactlab.solver.kink import bend_back
from impactlab.solver.resisted_pair import (
    PairResistance,
    make_resistance,
    resisted_energy,
    rest_resistance,
    take_work,
)
from impactlab.solver.resisted_shear import move_resisted
from impactlab.solver.section import FibreSection
from impactlab.solver.settle import ROUNDS, end_tangents, yield_on
from impactlab.solver.state import BeamModel, State
from impactlab.solver.timoshenko import Shear
from impactlab.solver.types import ONE, Array, Record

_AT_REST = 1e-13
"""Share by which the bending across the width still changes at rest."""


class Strip(NamedTuple):
    """The state of a strip besides BeamState; all arrays (last + 3,), at nodes.

    inertia: m (kg m3), 0 where nothing bends across; stiffness: D_s (N m2); twist: T (N m4);
    lever: l (m2). axis (m/N, m2): how much lower than the middle of the section the axis lies, per
    F and per M/(EI); lifting: the last arguments of contact/axis_lift.py, by how much it lies
    higher again. s (1/m): the curvature across the width, rate = dt s_t its increment, d_rate the
    last change of that; bent = s + nu kappa, where the step began. resistance: of the beam, which
    no strip has.
    """

    shear: Shear
    inertia: float
    stiffness: float
    twist: float
    lever: float
    axis: tuple[float, float]
    lifting: tuple[float, float, float]
    nu: float
    s: Array
    rate: Array
    d_rate: Array
    bent: Array
    resistance: PairResistance


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Strip:
    """Return the state at rest."""
    shear, size = timoshenko.make(case, section, grid), grid.last + 3
    z, nu = 0.5 * case.beam_depth, case.beam_poissons_ratio
    pressure = (1.0 + nu) * (5.0 - 2.0 * nu) / (8.0 * math.pi * case.beam_youngs_modulus * z**3)
    return Strip(
        shear,
        case.width_inertia,
        case.width_stiffness,
        case.width_twist,
        case.width_lever,
        (case.axis_compliance, case.axis_bending),
        (z, pressure, case.sphere_yield_stress),
        nu,
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        make_resistance(case, section, grid),
    )


@inlined
def _step(state: State, now: int, F: float) -> None:
    _, section, grid, beam, plastic, strip = state
    if strip.resistance.acts:
        shear = strip.shear
        take_work(beam, shear.spin, shear.d_spin, shear.inertia, strip.resistance, grid)
    per_dx = timoshenko.bend_sections(section, grid, beam, plastic, strip.shear, now)
    if strip.inertia > 0.0:
        _stretch(strip, per_dx, grid.last)
        _push_back(strip, -1.0, grid.last)
        _swing(strip, grid.dt**2 / strip.inertia, per_dx, F, grid)
    if strip.resistance.acts:
        move_resisted(grid, beam, strip.shear, strip.resistance, now, F, per_dx)
    else:
        timoshenko.move(grid, beam, strip.shear, now, F, per_dx)


@vectorised
def _stretch(strip: Strip, per_dx: float, last: int) -> None:
    psi = strip.shear.psi
    for i in range(np.uint64(2), np.uint64(last + 1)):
        strip.bent[i] = strip.s[i] + strip.nu * (psi[i] - psi[i - ONE]) * per_dx


@vectorised
def _push_back(strip: Strip, sign: float, last: int) -> None:
    """Add nu D_s bent to the beam's moments, or take it away."""
    M, share = strip.shear.M, sign * strip.nu * strip.stiffness
    for i in range(np.uint64(2), np.uint64(last + 1)):
        M[i] += share * strip.bent[i]


@inlined
def _mirror(s: Array, rate: Array, grid: BeamGrid) -> None:
    """Set the curvature across the width at and beyond the ends: it is 0 where they are held."""
    if grid.left == CLAMPED:
        s[2] = rate[2] = 0.0
    if grid.right == CLAMPED:
        s[grid.last] = rate[grid.last] = 0.0
    elif grid.right == SYMMETRIC:
        s[grid.last + 1] = s[grid.last - 1]


@vectorised
def _swing(strip: Strip, push: float, per_dx: float, F: float, grid: BeamGrid) -> None:
    """Move s by one step; push = dt^2/m."""
    s, rate, d_rate, bent = strip.s, strip.rate, strip.d_rate, strip.bent
    T, D = strip.twist * per_dx * per_dx, strip.stiffness
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        d_rate[i] = push * (T * (s[i - ONE] - 2.0 * s[i] + s[i + ONE]) - D * bent[i])
    d_rate[grid.mid] -= push * strip.lever * F * per_dx
    for i in range(np.uint64(2), np.uint64(grid.last + 1)):
        rate[i] += d_rate[i]
        s[i] += rate[i]
    _mirror(s, rate, grid)


@summing
def _width_energy(strip: Strip, grid: BeamGrid) -> float:
    """Return kinetic and elastic energy (J) of s after a step, at its beginning."""
    s, rate, d_rate, bent, last = strip.s, strip.rate, strip.d_rate, strip.bent, grid.last
    moved, bending, twisted = 0.0, 0.0, 0.0
    for i in range(np.uint64(grid.first), np.uint64(grid.stop)):
        moved += rate[i] * (rate[i] - d_rate[i])
        bending += bent[i] * bent[i]
    if grid.stop == last:
        moved += 0.5 * rate[last] * (rate[last] - d_rate[last])
        bending += 0.5 * bent[last] * bent[last]
    if grid.first > 2:  # clamped: at rest
        bending += 0.5 * bent[2] * bent[2]
    for i in range(np.uint64(grid.first - 1), np.uint64(grid.stop)):
        slope = (s[i + ONE] - rate[i + ONE] - s[i] + rate[i]) / grid.dx
        twisted += slope * slope
    kinetic = strip.inertia * moved / grid.dt**2
    per_length = kinetic + strip.stiffness * bending + strip.twist * twisted
    return 0.5 * grid.copies * grid.dx * per_length


@compiled
def _rest_across(strip: Strip, per_dx: float, grid: BeamGrid) -> float:
    """Put s to rest at the beam's curvatures; return by how much of itself `bent` changes.

    T s_xx - D_s s = D_s nu kappa, by elimination from the left end on.
    """
    s, above, right, psi = strip.s, strip.rate, strip.d_rate, strip.shear.psi
    T, D = strip.twist * per_dx * per_dx, strip.stiffness
    above[1] = right[1] = s[grid.last + 1] = 0.0
    for i in range(2, grid.last + 1):
        low = 2.0 * T if grid.right == SYMMETRIC and i == grid.last else T
        if (grid.left == CLAMPED and i == 2) or (grid.right == CLAMPED and i == grid.last):
            above[i] = right[i] = 0.0
            continue
        pivot = -2.0 * T - D - low * above[i - 1]
        above[i] = T / pivot if i < grid.last else 0.0
        kappa = (psi[i] - psi[i - 1]) * per_dx
        right[i] = (D * strip.nu * kappa - low * right[i - 1]) / pivot
    change = largest = 0.0
    for i in range(grid.last, 1, -1):
        s[i] = right[i] - above[i] * s[i + 1]
        bent = s[i] + strip.nu * (psi[i] - psi[i - 1]) * per_dx
        change, largest = max(change, abs(bent - strip.bent[i])), max(largest, abs(bent))
        strip.bent[i] = bent
    for i in range(s.size):
        strip.rate[i] = strip.d_rate[i] = 0.0
    _mirror(s, strip.rate, grid)
    return change / largest if largest > 0.0 else 0.0


@compiled
def _settle(state: State) -> None:
    """Put beam and width to rest by turns: each changes the other's part by a tenth."""
    _, section, grid, beam, plastic, strip = state
    shear, per_dx, bed = strip.shear, 1.0 / grid.dx, strip.resistance.bed * grid.mu / grid.dt**2
    rest_resistance(strip.resistance)
    end_tangents(beam, plastic, section, grid)
    for i in range(strip.bent.size):
        strip.bent[i] = 0.0
    for _ in range(ROUNDS):
        for i in range(2, grid.last + 1):
            shear.M[i] = plastic.M_0[i] - strip.nu * strip.stiffness * strip.bent[i]
        timoshenko.rest(section, grid, beam, plastic, shear, shear.M, bed)
        change = 0.0
        if strip.inertia > 0.0:
            change = _rest_across(strip, per_dx, grid)
            _push_back(strip, -1.0, grid.last)
        if change <= _AT_REST and not yield_on(beam, shear.psi, plastic, section, grid):
            break


@compiled
def _curvature(state: State, now: int) -> float:
    psi, grid = state.extra.shear.psi, state.grid
    return curvature(state.beam.w, now, psi, grid, np.uint64(grid.mid))


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    _, section, grid, beam, plastic, strip = state
    stored, dissipated = plastic_energy(plastic, section, grid)
    total = stored + dissipated
    if strip.inertia > 0.0:
        _push_back(strip, 1.0, grid.last)  # the fibres' own moments; the next step sets them anew
        total += _width_energy(strip, grid)
    shear = strip.shear
    total += timoshenko.shear_energy(beam, shear, plastic.M_0, section.stiffness, grid)
    total += timoshenko.spring_energy(beam, now, shear.psi, shear.spin, grid)
    if strip.resistance.acts:
        total += resisted_energy(
            beam, now, shear.spin, shear.d_spin, shear.inertia, strip.resistance, grid
        )
    return total


@compiled
def _sag(state: State) -> float:
    return -state.extra.lever * state.extra.s[state.grid.mid]


@compiled
def _beneath(state: State, now: int, F: float) -> float:
    c, gamma = state.extra.axis
    elastic = state.plastic.M_0[state.grid.mid] / state.section.stiffness - _curvature(state, now)
    return float(c * F + gamma * elastic)


@compiled
def _lift(state: State, contact: Record, F: float) -> float:
    strip = state.extra
    if strip.inertia == 0.0:
        return 0.0
    return axis_lift(contact, state.pair, F, *strip.lifting)


@compiled
def _moments(state: State, now: int) -> tuple[float, float]:
    strip, section, mid = state.extra, state.section, state.grid.mid
    kappa = _curvature(state, now)
    across = 0.0
    if strip.inertia > 0.0:
        across = -strip.stiffness * (strip.s[mid] + strip.nu * kappa)
    return float(state.plastic.M_0[mid] - section.stiffness * kappa + strip.nu * across), across


@compiled
def _bend_back(state: State, now: int, contact: Record, growth: float) -> None:
    if growth == 0.0:
        return
    before, _ = _moments(state, now)
    bend_back(state.beam, now, state.extra.shear.psi, state.grid, growth)
    after, _ = _moments(state, now)
    contact.kink += growth
    contact.kink_work += 0.5 * (before + after) * growth


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    ahead, _, _ = spread_over_nodes(
        state.beam, state.grid, now, F / (1.0 + state.extra.resistance.h), a
    )
    return ahead, 0.0


@compiled
def _push(state: State, now: int, nodes: Array, forces: Array) -> float:
    grid, strip = state.grid, state.extra
    push_nodes(state.beam, grid, now, nodes, forces, 1.0 / (1.0 + strip.resistance.h))
    if strip.inertia > 0.0:
        for k in range(nodes.size):
            i, change = nodes[k], grid.dt**2 / strip.inertia * strip.lever * forces[k] / grid.dx
            strip.d_rate[i] -= change
            strip.rate[i] -= change
            strip.s[i] -= change
    return 0.0


MODEL = BeamModel(
    _make,
    _step,
    _curvature,
    _energy,
    deflected,
    _spread,
    _settle,
    sag=_sag,
    beneath=_beneath,
    lift=_lift,
    moments=_moments,
    bend_back=_bend_back,
    push=_push,
)
