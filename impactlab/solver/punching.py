"""The struck section sinks below the beam: with `contact_prestress: bending`.

Where the force is not small beside what the section bears in shear, metal that flows beneath the
contact flows downwards as well, and takes the axis with it, further than the beam deflects, by

    0.25 delta_m (F/(S_y H sqrt(B H)))^3.5

as long as that grows. H sqrt(B H) lies between the section, B H, which a beam shears along, and the
depth times the contact's circle, along which a plate is punched. It is no part of the indentation,
which counts from the axis. The numbers were fitted, with the depth's part of the crowding
(model/contact_compliance.py), to force and indentation of some 40 impacts in 3-D finite
elements (tests/benchmarks/large_contacts.py).
"""

import math

from impactlab.solver.contact.history import Pair, yield_stress
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

SHARE = 0.25


@compiled
def punch(case: Record, contact: Record, pair: Pair, F: float, before: float) -> None:
    """Let the struck section sink under a contact that has yielded, from the next step on.

    F, before: the force now and a step before (N).
    """
    contact.punching_work += 0.5 * (before + F) * (contact.sunk - contact.sunk_before)
    contact.sunk_before = contact.sunk
    if contact.delta_r > 0.0:
        S_y = max(case.beam_yield_stress, yield_stress(contact, pair))
        shear = F / (S_y * case.beam_depth * math.sqrt(case.beam_width * case.beam_depth))
        sinks = SHARE * contact.delta_m * shear**3 * math.sqrt(shear)
        contact.sunk = max(contact.sunk, sinks)
