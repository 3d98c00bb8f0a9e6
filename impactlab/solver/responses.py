"""The responses of a run, from the events of its march and its final state.

Names, units and meanings: outputs.py. Each function fills the responses that the run can give into
a blank record, and says in its bits why others are missing.
"""

import math

import numpy as np

from impactlab.solver.beam import CLAMPED, SPRUNG, BeamGrid
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.finite_element import (
    LARGEST_CIRCLE,
    LARGEST_CIRCLE_ACROSS,
    LARGEST_FORCE,
    LARGEST_HARDENING,
    LARGEST_POISSONS_RATIO,
    LARGEST_STIFFNESS,
    LEAST_DENT,
    LEAST_HARDNESS,
    LEAST_POISSONS_RATIO,
    LEAST_STIFFNESS,
    SMALLEST_DEPTH,
)
from impactlab.solver.contact.history import Pair, energies, pair_radius, yield_stress
from impactlab.solver.contact.metals import (
    FAR_REVERSAL,
    LARGEST_HARDENED,
    LARGEST_HARDENED_FAR,
    LARGEST_RATIO,
    LARGEST_REVERSAL,
    LEAST_RATIO,
    hardened,
    reversal,
)
from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.contact.switch import is_damped, limit
from impactlab.solver.event_tracker import largest_load
from impactlab.solver.jit import compiled
from impactlab.solver.outputs import (
    CONTACT_CIRCLE_OUTSIDE_DATA,
    CONTACT_CREATED_ENERGY,
    CONTACT_FORCE_OUTSIDE_DATA,
    CONTACT_LEFT_A_BULGE,
    DEFLECTION_STILL_GROWING,
    FIRST_CONTACT_UNFINISHED,
    HARDENING_OUTSIDE_DATA,
    IN_CONTACT_AT_END,
    INDENTATION_STILL_GROWING,
    OUTSIDE_CONTACT_LAW,
    POISSONS_RATIO_OUTSIDE_DATA,
    ROUND_TOP,
    SHALLOW_DENT,
    SKIN_MAY_GIVE,
    SPHERE_NOT_LEAVING,
    SPHERE_YIELD_OUTSIDE_DATA,
    STIFFNESS_RATIO_OUTSIDE_DATA,
    STRETCHING_LEFT_OUT,
    STRUCK_NEAR_END,
    WALL_MAY_DENT,
    YIELD_RATIO_OUTSIDE_DATA,
)
from impactlab.solver.types import (
    CIRCLE,
    LAMINATE,
    RECTANGLE,
    TUBE,
    VON_KARMAN,
    Array,
    Record,
)

PLASTIC_ZONE_STRAIN = 1e-5
"""PEEQ from which on a section counts as plastic."""
LARGEST_COMPLIANCE = 0.45
"""Of the contact, over that of its law, taken back by the bodies' ends: beyond it the circle is not
small beside them."""
LARGEST_CIRCLE_ON_SKIN = 0.2
"""Radius of the contact over the outer layer's thickness: beyond it the layer beneath matters.

There a third of the modulus beneath takes 10 % off that of the indented layer, and 2 % off the
force of an elastic impact. Weights: Gao, Chiu, Lee, Int. J. Solids Struct. 29 (1992) 2471
(recalled).
"""
_FINITE_ELEMENT = LAWS.index("finite_element")
LARGEST_STRETCHING = 0.02
"""Share of the largest deflection from which on a beam's stretching is not left out tacitly."""
_ROUNDING = 1e-9
"""Share of the loading work below which the contact has created no energy."""


@compiled
def read_contact(answer: Record, events: Record, contact: Record, pair: Pair) -> None:
    """Fill in force, indentation and contact times; flag those beyond the contact law's range."""
    recovers = LARGEST_COMPLIANCE * (contact.delta_m - contact.delta_r)
    if (
        contact.delta_m > limit(pair.law, pair.E, pair.R, yield_stress(contact, pair), pair.nu)
        or -pair.compliance * contact.n * contact.F_m > recovers
    ):
        answer.status |= OUTSIDE_CONTACT_LAW
    further = events.before >= 0.0
    if events.delta == contact.approach_m or (further and np.isnan(events.t_peak)):
        answer.status |= INDENTATION_STILL_GROWING
    else:
        tracked = pair.prestress[0] > 0.0 or is_damped(pair.law) or pair.rate.D > 0.0
        largest, approach = largest_load(events, contact)
        answer.peak_force = contact.peak_force if tracked else largest
        answer.time_of_peak_force = events.t_peak
        bends = pair.bending != 0.0
        answer.maximum_indentation = contact.largest if bends else approach
    answer.number_of_contacts = events.contacts
    answer.contact_duration = events.t_first_end - events.t_begin
    if np.isnan(events.t_first_end):
        answer.status |= FIRST_CONTACT_UNFINISHED
    if events.touching == 1.0:
        answer.status |= IN_CONTACT_AT_END
    else:
        answer.total_contact_time = events.time_in_contact
        answer.permanent_indentation = contact.delta_r
        answer.impulse = events.impulse
        if events.time_in_contact > 0.0:
            answer.mean_force = events.impulse / events.time_in_contact
        _, answer.contact_dissipation = energies(contact, pair, events.delta)
        if answer.contact_dissipation < -_ROUNDING * contact.work:
            answer.remarks |= CONTACT_CREATED_ENERGY
        if contact.delta_r < 0.0:
            answer.remarks |= CONTACT_LEFT_A_BULGE
        fitted = pair.law == _FINITE_ELEMENT and contact.delta_r > 0.0
        if fitted and contact.delta_r < LEAST_DENT * contact.delta_m:
            answer.remarks |= SHALLOW_DENT


@compiled
def read_inputs(answer: Record, case: Record, contact: Record, pair: Pair) -> None:
    """Remark which inputs lie outside the data of the law finite_element and of the corrections.

    Also a strike so near an end that the body under the contact is no half-space, and a section
    that is none.

    Those of materials count where the contact yields, with the law, a strip or prestress.
    """
    if min(case.strike_position, 1.0 - case.strike_position) * case.beam_span < case.beam_depth:
        answer.remarks |= STRUCK_NEAR_END
    read_shape(answer, case.beam_shape)
    S_y = yield_stress(contact, pair)
    read_skin(answer, case.skin_thickness, contact, pair)
    corrected = case.contact_prestress > 0 or case.width_inertia > 0.0
    if corrected or pair.compliance != 0.0:
        read_size(answer, case, contact, pair)
    x = contact.delta_m / yield_indentation(pair.E, pair.R, S_y)
    is_fit = pair.law == _FINITE_ELEMENT
    if not ((x > 1.0 and (corrected or is_fit)) or (is_fit and contact.delta_r > 0.0)):
        return
    if not LEAST_RATIO <= pair.E / S_y <= LARGEST_RATIO:
        answer.remarks |= YIELD_RATIO_OUTSIDE_DATA
    if not LEAST_POISSONS_RATIO <= case.beam_poissons_ratio <= LARGEST_POISSONS_RATIO:
        answer.remarks |= POISSONS_RATIO_OUTSIDE_DATA
    hardening = case.beam_isotropic_hardening_modulus + case.beam_kinematic_hardening_modulus
    outside = hardening > LARGEST_HARDENING * case.beam_youngs_modulus
    z = reversal(np.sqrt(x), pair.shape)
    outside |= z > LARGEST_REVERSAL
    is_far = contact.delta_m > SMALLEST_DEPTH * pair.R or z > FAR_REVERSAL
    largest = LARGEST_HARDENED_FAR if is_far else LARGEST_HARDENED
    outside |= hardened(pair.shape[25], x) * S_y > largest * case.sphere_yield_stress
    if outside:
        answer.remarks |= HARDENING_OUTSIDE_DATA
    if case.sphere_yield_stress < LEAST_HARDNESS * max(case.beam_yield_stress, S_y):
        answer.remarks |= SPHERE_YIELD_OUTSIDE_DATA
    stiffness = case.sphere_youngs_modulus / case.beam_youngs_modulus
    if not LEAST_STIFFNESS <= stiffness <= LARGEST_STIFFNESS:
        answer.remarks |= STIFFNESS_RATIO_OUTSIDE_DATA


@compiled
def read_size(answer: Record, case: Record, contact: Record, pair: Pair) -> None:
    """Remark a contact that is not small beside the beam's section."""
    a = pair_radius(pair, contact.delta_m, yield_stress(contact, pair))
    largest = min(LARGEST_CIRCLE * case.beam_depth, LARGEST_CIRCLE_ACROSS * case.beam_width)
    if a > 0.5 * largest:
        answer.remarks |= CONTACT_CIRCLE_OUTSIDE_DATA
    yields = case.beam_yield_stress * case.beam_width * case.beam_depth
    if case.beam_depth >= 0.5 * case.beam_width and contact.F_m > LARGEST_FORCE * yields:
        answer.remarks |= CONTACT_FORCE_OUTSIDE_DATA


@compiled
def read_shape(answer: Record, shape: int) -> None:
    """Remark what the beam lacks under the sphere; shape: its number."""
    if shape not in (RECTANGLE, CIRCLE, LAMINATE):
        answer.remarks |= WALL_MAY_DENT
    if shape in (CIRCLE, TUBE):
        answer.remarks |= ROUND_TOP


@compiled
def stretching(case: Record, w: float) -> float:
    """Estimate what stretching takes off a largest deflection w (m) under the sphere, in shares.

    Of a beam that swings in one shape, half a sine wave to the power n, all of whose energy is
    elastic at its largest deflection: half the ratio of its energies of stretching and of bending,
    1/16 (pinned, n = 1) or 1/64 (clamped, n = 2) of (w/r)^2 with the radius of gyration r, and the
    geometric mean for one of both. On 40 impacts it is 0.5 to 2.8 times what the model von_karman
    gives, where that is below 30 %.
    """
    if case.axis_held_left == 0 or case.axis_held_right == 0:
        return 0.0
    n = 1.0
    for support in (case.support_left, case.support_right):
        if support == SPRUNG:  # how much of w bends the beam is not known
            return 0.0
        n += 0.5 if support == CLAMPED else 0.0
    shape = max(math.sin(math.pi * case.strike_position), 0.0) ** n
    square = w * w * case.mass_per_length / case.rotary_inertia
    return float(square / (shape * shape * 4.0 ** (n + 1.0)))


@compiled
def sphere_leaves(events: Record) -> bool:
    """Return whether the sphere moves upwards and away from the beam."""
    return not (events.touching == 1.0 or events.v_s >= 0.0 or events.v_s >= events.v_mid)


@compiled
def read_strike(
    row: Array,
    dent: float,
    w: float,
    yielded: float,
    case: Record,
    events: Record,
    contact: Record,
    pair: Pair,
) -> None:
    """Fill in outputs.SERIES of a strike, if the sphere has left.

    dent, w: of the beam at rest (m). yielded: what its fibres have dissipated (J).
    """
    if not sphere_leaves(events):
        return
    tracked = pair.prestress[0] > 0.0 or is_damped(pair.law) or pair.rate.D > 0.0
    largest, _ = largest_load(events, contact)
    row[0], row[1] = dent, w
    row[2] = contact.peak_force if tracked else largest
    row[3], row[4] = -events.v_exit / case.velocity, -events.v_exit
    _, row[5] = energies(contact, pair, events.delta)
    row[6] = yielded


@compiled
def read_skin(answer: Record, thickness: float, contact: Record, pair: Pair) -> None:
    """Remark a contact that is not small beside the outer layer; thickness: its (m), 0: none."""
    if thickness > 0.0:
        a = pair_radius(pair, contact.delta_m, yield_stress(contact, pair))
        if a > LARGEST_CIRCLE_ON_SKIN * thickness:
            answer.remarks |= SKIN_MAY_GIVE


@compiled
def read_rebound(answer: Record, case: Record, events: Record) -> None:
    """Fill in the rebound, once the sphere moves upwards and away from the beam."""
    if not sphere_leaves(events):
        answer.status |= SPHERE_NOT_LEAVING
    else:
        answer.rebound_velocity = -events.v_exit
        answer.restitution = -events.v_exit / case.velocity


@compiled
def read_beam(
    answer: Record,
    case: Record,
    events: Record,
    peeq: Array,
    ratio: Array,
    grid: BeamGrid,
    dissipated: float,
) -> None:
    """Fill in deflection and plastic strain; peeq: see PlasticState; ratio: of strains."""
    if events.w > events.w_max:
        answer.status |= DEFLECTION_STILL_GROWING
    else:
        answer.maximum_deflection = events.w_max
        stretches = case.beam_model == VON_KARMAN
        if not stretches and stretching(case, events.w_max) > LARGEST_STRETCHING:
            answer.remarks |= STRETCHING_LEFT_OUT
    answer.peak_plastic_strain = max(_largest(peeq, ratio, 1), _largest(peeq, ratio, grid.last + 1))
    answer.remote_plastic_strain = 0.0
    answer.plastic_zone_length = 0.0
    strain_before = _largest(peeq, ratio, 1)
    for i in range(2, grid.last + 1):
        strain = _largest(peeq, ratio, i)
        answer.peak_plastic_strain = max(answer.peak_plastic_strain, strain)
        if abs(grid.mid - i) * grid.dx > case.beam_depth:
            answer.remote_plastic_strain = max(answer.remote_plastic_strain, strain)
        share = share_above(strain_before, strain, PLASTIC_ZONE_STRAIN)
        if i > 2 or grid.first == 2:  # an end that is no pinned one has no spacing before it
            answer.plastic_zone_length += grid.copies * grid.dx * share
        strain_before = strain
    if grid.stop > grid.last:  # pinned
        share = share_above(
            strain_before, _largest(peeq, ratio, grid.last + 1), PLASTIC_ZONE_STRAIN
        )
        answer.plastic_zone_length += grid.dx * share
    answer.plastic_dissipation = dissipated


@compiled
def _largest(peeq: Array, ratio: Array, i: int) -> float:
    """Return the largest strain of the fibres of section i."""
    strain = 0.0
    for j in range(peeq.shape[1]):
        strain = max(strain, ratio[j] * peeq[i, j])
    return strain


@compiled
def share_above(left: float, right: float, threshold: float) -> float:
    """Return the share of a cell where the line from `left` to `right` is above the threshold."""
    high, low = max(left, right), min(left, right)
    if low >= threshold:
        return 1.0
    if high <= threshold:
        return 0.0
    return (high - threshold) / (high - low)
