"""Durations that end before a run can give its responses."""

from typing import Any

import numpy as np

from impactlab.model.cost import contact_time, flies, swing
from impactlab.model.quantities import engineering
from impactlab.solver import outputs
from impactlab.variables import FAILURES, RESPONSES

_SWINGS = {
    outputs.INDENTATION_STILL_GROWING: 0.0,
    outputs.FIRST_CONTACT_UNFINISHED: 0.0,
    outputs.DEFLECTION_STILL_GROWING: 0.75,
    outputs.IN_CONTACT_AT_END: 1.0,
    outputs.SPHERE_NOT_LEAVING: 1.0,
    outputs.EARLIER_STRIKE_UNFINISHED: 1.0,
}
"""By status bit of a short duration: how many swings a run lasts that gives the response."""


def too_short(cases: Any, status: Any) -> str:
    """Return which responses runs are too short for, and a duration that lasts; "" for none.

    cases: records of solver.types.CASE of one duration. status: of each. No duration is stated
    where gravity takes a sphere's velocity in three swings, or the duration should have lasted. The
    deflection of a beam that moves off grows as long as it does, so no duration is asked for it.
    """
    status = np.ravel(status)
    diverged = status & outputs.DIVERGED != 0
    status = np.where(flies(cases), status & ~outputs.DEFLECTION_STILL_GROWING, status)
    bits = np.where(diverged, 0, status)[:, None] & np.array(list(_SWINGS))
    short = bits.any(axis=1)
    if not short.any():
        return ""
    missing = {
        entry.name: entry.missing and FAILURES[entry.missing] for entry in RESPONSES.values()
    }
    names = [name for name, reason in missing.items() if reason and reason[0] in bits]
    if outputs.EARLIER_STRIKE_UNFINISHED in bits:
        names += ["strikes before the last"]
    swings, cases = np.where(bits, list(_SWINGS.values()), 0.0).max(axis=1)[short], cases[short]
    seconds = cases[0]["duration"]
    lasting = contact_time(cases) + swings * swing(cases)
    remedy = f"take about {engineering(max(lasting.max(), 2.0 * seconds), 's', 2)}"
    slow = cases["velocity"] < 3.0 * cases["gravity"] * swing(cases)
    if ((swings == 1.0) & (slow | (lasting < seconds))).any():
        remedy = "try a longer one; at its end, too, the beam may be moving up behind the sphere"
    short_for = ", ".join(names)
    runs = f" in {cases.size:,} of {status.size:,} runs" if status.size > 1 else ""
    return f"duration = {engineering(seconds, 's')} is too short for {short_for}{runs}: {remedy}"
