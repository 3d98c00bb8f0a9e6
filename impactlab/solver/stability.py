"""The largest time steps, of each model of the beam and scheme in time.

Leapfrog is stable up to 2/omega, with k_c the stiffness of the contact:
    the paper's beam  omega^2 <= 16 (EI)_q/(rho A dx^4) + k_c (1/(rho A dx) + 1/m_s)
                      (docs/theory.md, in the place of the paper's bar-wave limit), at all ends: of
                      the row sums of the curvatures' matrix, a free or clamped end's are smaller; a
                      free end that is struck has half the mass in the second term; the stiffest
                      spring of an elastic end adds 2 k_t/(rho A dx),
                      and a foundation k/(rho A)
    Timoshenko beam   4 (EI)_q/(rho I dx^2) + k G A/(rho I) + 4 k G A/(rho A dx^2) as first term
                      with any ends, too, and with springs and foundation as above
    von Karman's      4 (1 + s^2) E/(rho dx^2) beside the first term, of stretching under the slope
    beam              s; 0.3 is taken for s, up to which rotations count as moderate
    strip             beside Timoshenko's (D_s + 4 T/dx^2)/m + 4 nu^2 D_s/(rho I dx^2), and the
                      force's lever on m in the contact's (strip.py): a sum of potentials has at
                      most the sum of their largest omega^2
    lumped            k_c/m_s, and (k_c + k)/m_b of the spring-mass model; a thousandth of it is
                      taken, for accuracy: no wave asks for small steps here
The modal scheme takes the time in which a bar wave crosses a spacing, for accuracy. For stability
D (modal.py) and dt^2 times the contact's term above must not exceed 4 together; D is at most 2:
dt <= sqrt(2/contact), where n modes and the sum of those left out count 4/3 + 7/(6 n) times
1/(rho A dx) at most (docs/modal.md), n half the spacings; others than sines 0.07 more, and four
times as much at a free end, where modes are twice as large. That is mostly far beyond, which few
indentations show.

Contacts of several spheres push nodes and spheres of their own, so that by leapfrog the largest
term of one of them counts. Modes are pushed by all, and the sum of these terms bounds what they do.

A damper c of the contact (N s/m) counts as 4 c/dt beside k_c (contact_damping.py). With h, a half
(modal: the whole) of c dt times what k_c is multiplied by, this makes the largest dt smaller by
sqrt(1 + h^2) - h. Leapfrog's lagging damping beta of the bending stiffness (resistance.py) adds
beta omega^2 dt/4 to h, of the first term, with which dt^2 omega^2 + 2 beta dt omega^2 <= 4; damping
of the mass, which is central, and that of modes (resisted_modes.py) change nothing.
"""

import math

from impactlab.solver.beam import PINNED, SPRUNG, BeamGrid, half_spacings, make_grid
from impactlab.solver.contact.history import (
    PANELS,
    Pair,
    loading_work,
    make_pair,
    pair_curve,
    pair_radius,
)
from impactlab.solver.contact.rate import MODULUS, STRAIN
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.contact.switch import damping, is_damped
from impactlab.solver.jit import compiled
from impactlab.solver.lumped import mid_span
from impactlab.solver.responses import LARGEST_COMPLIANCE
from impactlab.solver.section import FibreSection
from impactlab.solver.strain_rate import rate_factor
from impactlab.solver.types import MODAL, SPRING_MASS, TIMOSHENKO, VON_KARMAN, Array, Record

_GROWTH, _COARSE_GROWTH = 1.25, 2.0
_SAFETY = 2.0
"""Between the few indentations the contact is less than so many times as stiff as at them."""
_LARGEST_SHARE = 0.01
"""Of the loading work, in energy that a jump at the turn may bring at the critical time step."""
_LUMPED_STEPS = 1000.0
LARGEST_SLOPE = 0.3
"""Of the beam that stretches, for the time step."""
_UNEVEN = 0.07
_SMALL = 1e-4
"""Share of an argument by which differences are taken."""


@compiled
def _stiffness(pair: Pair, delta: float) -> tuple[float, float]:
    """Return the largest tangent stiffness (N/m) of loading and of unloading at delta; the force.

    A jump of the force at the limit of a regime is no stiffness: it falls into the difference
    to one side alone. Where unloading begins with a jump, up to a step is made under the wrong
    force, which brings an energy of jump^2 dt^2/m; with dt^2/m = 4/k it is a share 4 jump^2/(k W)
    of the loading work W, of which 0.4 F delta is taken.
    """
    F, K, delta_r, n = pair_curve(pair, delta, pair.S_y)
    small = _SMALL * delta
    after, _, _, _ = pair_curve(pair, delta + small, pair.S_y)
    before, _, _, _ = pair_curve(pair, delta - small, pair.S_y)
    loading = min(after - F, F - before) / small
    start = K * max(delta - delta_r, 0.0) ** n
    unloading = n * start / (delta - delta_r)
    if pair.rate.D > 0.0:  # the yield stress grows with the strain, at most as a fibre's (rate.py)
        little = _SMALL * pair.S_y
        harder, _, _, _ = pair_curve(pair, delta, pair.S_y + little)
        softer, _, _, _ = pair_curve(pair, delta, pair.S_y - little)
        a = pair_radius(pair, delta, pair.S_y)
        wider = pair_radius(pair, delta + small, pair.S_y)
        growth = MODULUS * STRAIN * pair.E * (wider - a) / (pair.R * small)
        loading += growth * min(harder - F, F - softer) / little
    turning = 10.0 * (F - start) ** 2 / (_LARGEST_SHARE * F * delta)
    return max(loading, unloading, turning), F


@compiled
def _hardened(case: Record, pair: Pair) -> Pair:
    """Return the pair with the yield stress at the largest strain rate, that at first yield."""
    delta_y = yield_indentation(pair.E, pair.R, pair.S_y)
    strain_rate = STRAIN * case.velocity / (2.0 * math.sqrt(pair.R * delta_y))
    S_y = min(pair.S_y * rate_factor(strain_rate, pair.rate), pair.hardest)
    return Pair(pair.law, pair.E, pair.R, S_y, *pair[4:])


@compiled
def stiffest_contact(case: Record, pair: Pair, growth: float = _GROWTH) -> float:
    """Return k_c in N/m, over all indentations that the sphere's energy can drive."""
    return _extremes(case, pair, growth)[0]


@compiled
def _extremes(case: Record, pair: Pair, growth: float) -> tuple[float, float]:
    """Return the largest k_c (N/m) and damping (N s/m) of the contact.

    The indentation is raised until loading has taken all of that energy: no impact on a beam,
    which takes a part of it, goes deeper. growth: from one indentation to the next.
    """
    energy = 0.5 * case.sphere_mass * case.velocity**2
    hertz = 4.0 / 3.0 * pair.E * math.sqrt(pair.R)
    delta = 0.1 * (2.5 * energy / hertz) ** 0.4
    energy *= case.strikes  # where a strike ends, loading goes on in the next
    work, panels = 0.0, 1 if case.scheme == MODAL else PANELS
    k_c, F = _stiffness(pair, delta)
    hard = _hardened(case, pair)
    while work < energy + case.sphere_mass * case.gravity * delta and delta < pair.R:
        k, F_next = _stiffness(pair, growth * delta)
        if growth > _GROWTH:
            work += 0.5 * (F + F_next) * (growth - 1.0) * delta
        else:
            work += loading_work(pair, delta, growth * delta, panels)
        if pair.compliance != 0.0:  # of the spring in series
            work += 0.5 * pair.compliance * (F_next * F_next - F * F)
        delta *= growth
        k_c, F = max(k_c, k), F_next
        if pair.rate.D > 0.0:
            k_c = max(k_c, _stiffness(hard, delta)[0])
    v, c = case.velocity, 0.0
    if is_damped(pair.law):  # which grows with the force
        c = damping(pair.law, F, delta, v, pair.E, pair.R, pair.S_y, pair.nu) / v
    return k_c / max(1.0 + pair.compliance * k_c, 1.0 - LARGEST_COMPLIANCE), c


@compiled
def _damped(dt: float, h: float) -> float:
    """Return the largest step (s) under damping; dt (s): without."""
    return dt * (math.sqrt(1.0 + h * h) - h)


@compiled
def _further_push(case: Record) -> float:
    """Return what the modes' push at the struck node has beyond a node's, in shares of that."""
    share = 1.0 / 3.0 + 7.0 / (6.0 * half_spacings(case.nodes))
    if case.strike_position == 0.0 or case.strike_position == 1.0:
        return 4.0 * (1.0 + share + _UNEVEN) - 2.0
    sines = case.support_left == PINNED and case.support_right == PINNED and case.further == 0
    return share if sines and case.strike_position == 0.5 else share + _UNEVEN


@compiled
def largest_time_step(case: Record, pair: Pair, EI: float, dx: float) -> float:
    """Return the largest step in s, of the case's beam model and scheme.

    EI: the integration rule's (N m2); dx: node spacing (m).
    """
    mu, node = case.mass_per_length, case.mass_per_length * dx
    if case.strike_position == 0.0 or case.strike_position == 1.0:  # a free end
        node *= 0.5
    push = 1.0 / node + 1.0 / case.sphere_mass
    if case.scheme == MODAL:
        wave = dx * math.sqrt(case.beam_density / case.beam_youngs_modulus)
        push += _further_push(case) / (mu * dx)
        push += case.further * (push - 1.0 / case.sphere_mass)
        about = _SAFETY * stiffest_contact(case, pair, _COARSE_GROWTH)
        if about * push * wave * wave < 2.0 and not is_damped(pair.law):
            return wave
        k_c, c = _extremes(case, pair, _GROWTH)
        dt = math.sqrt(2.0 / (k_c * push))
        return min(wave, _damped(dt, c * push * dt))
    k_c, c = _extremes(case, pair, _GROWTH)
    if case.beam_model >= SPRING_MASS:
        omega_squared = k_c / case.sphere_mass
        if case.beam_model == SPRING_MASS:
            mass, stiffness = mid_span(case, EI)
            omega_squared += (k_c + stiffness) / mass
        return 2.0 / math.sqrt(omega_squared) / _LUMPED_STEPS
    contact = k_c * push
    if case.beam_model == TIMOSHENKO:
        inertia, kGA = case.rotary_inertia, case.shear_stiffness
        omega_squared = (4.0 * EI / dx**2 + kGA) / inertia
        omega_squared += 4.0 * kGA / (mu * dx**2)
        if case.width_inertia > 0.0:
            D_s, twist = case.width_stiffness, case.width_twist
            omega_squared += (D_s + 4.0 * twist / dx**2) / case.width_inertia
            omega_squared += 4.0 * case.beam_poissons_ratio**2 * D_s / (inertia * dx**2)
            contact += k_c * case.width_lever**2 / (case.width_inertia * dx)
    else:
        omega_squared = 16.0 * EI / (mu * dx**4)
    left = case.stiffness_left if case.support_left == SPRUNG else 0.0
    right = case.stiffness_right if case.support_right == SPRUNG else 0.0
    omega_squared += 2.0 * max(left, right) / (mu * dx)
    if case.beam_model == VON_KARMAN:
        wave_squared = case.beam_youngs_modulus / case.beam_density
        omega_squared += 4.0 * (1.0 + LARGEST_SLOPE**2) * wave_squared / dx**2
    omega_squared += case.foundation_stiffness / mu
    dt = 2.0 / math.sqrt(omega_squared + contact)
    lag = 0.25 * case.stiffness_damping * omega_squared * dt
    return _damped(dt, 0.5 * c * contact / k_c * dt + lag)


@compiled
def grid_of(case: Record, dx: float, dt: float, EI: float) -> BeamGrid:
    """Return the grid of a case's beam, of spacing dx (m) and step dt (s)."""
    ends, struck = (case.support_left, case.support_right), struck_node(case)
    alike = case.beam_model != VON_KARMAN or case.axis_held_left == case.axis_held_right
    alike = alike and case.further == 0
    return make_grid(
        case.nodes,
        dx,
        dt,
        case.mass_per_length,
        EI,
        *ends,
        struck,
        case.stiffness_left,
        case.stiffness_right,
        case.rotational_stiffness_left,
        case.rotational_stiffness_right,
        alike,
    )


@compiled
def struck_node(case: Record) -> int:
    """Return the node of a case's beam that is struck, counted from 0 at the left end."""
    return int(case.strike_position * (case.nodes - 1) + 0.5)


@compiled
def divided(case: Record, EI: float, steps: int) -> BeamGrid:
    """Return the grid of a case's beam, of bending stiffness EI (N m2), with so many time steps."""
    return grid_of(case, case.beam_span / (case.nodes - 1), case.duration / steps, EI)


@compiled
def step_count(case: Record, pair: Pair, EI: float) -> int:
    """Return the number of time steps of a case, whose beam has the bending stiffness EI (N m2)."""
    dx = case.beam_span / (case.nodes - 1)
    return math.ceil(case.duration / (case.courant * largest_time_step(case, pair, EI, dx)))


@compiled
def discretise(case: Record, pair: Pair, section: FibreSection) -> tuple[BeamGrid, int]:
    """Return (grid, number of time steps) of a case."""
    steps = step_count(case, pair, section.stiffness)
    return divided(case, section.stiffness, steps), steps


@compiled
def count_steps(cases: Array, fastest: Array, fibres: Array, steps: Array) -> None:
    """Fill in the number of time steps of each case: a kernel of its own, compiled beside others.

    fastest: the cases, with the sphere that asks for the smallest step. fibres: as by
    model.section.fibre_table.
    """
    for r in range(cases.size):
        EI = 0.0
        for j in range(cases[r].points // 2):
            z = fibres[r, 0, j]
            EI += cases[r].beam_youngs_modulus * fibres[r, 1, j] * z * z
        steps[r] = step_count(fastest[r], make_pair(cases[r]), EI)
