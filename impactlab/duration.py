"""Durations that end before a run can give its responses."""

from __future__ import annotations

from typing import Any

from impactlab.model.cost import contact_time, swing
from impactlab.model.quantities import engineering
from impactlab.solver import outputs
from impactlab.variables import FAILURES, RESPONSES

_SWINGS = {
    outputs.INDENTATION_STILL_GROWING: 0.0,
    outputs.FIRST_CONTACT_UNFINISHED: 0.0,
    outputs.DEFLECTION_STILL_GROWING: 0.75,
    outputs.IN_CONTACT_AT_END: 1.0,
    outputs.SPHERE_NOT_LEAVING: 1.0,
}
"""By status bit of a short duration: how many swings a run lasts that gives the response."""


def too_short(case: Any, status: int) -> str:
    """Return which responses a run is too short for, and a duration that lasts; "" for none.

    case: a record of solver.types.CASE. No duration is given where gravity takes the sphere's
    velocity in three swings: it may rest on the beam.
    """
    bits = [bit for bit in _SWINGS if status & bit]
    if not bits or status & outputs.DIVERGED:
        return ""
    missing = {
        entry.name: entry.missing and FAILURES[entry.missing] for entry in RESPONSES.values()
    }
    names = ", ".join(name for name, reason in missing.items() if reason and reason[0] in bits)
    swings = max(map(_SWINGS.__getitem__, bits))
    lasting = max(contact_time(case) + swings * swing(case), 2.0 * case["duration"])
    remedy = f"take about {engineering(lasting, 's', 2)}"
    if swings == 1.0 and case["velocity"] < 3.0 * case["gravity"] * swing(case):
        remedy = "take a longer one, unless gravity keeps the sphere on the beam"
    return f"duration = {engineering(case['duration'], 's')} is too short for {names}: {remedy}"
