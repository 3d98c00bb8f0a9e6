"""The scalar answers of a run, and `status`, which says why one is missing."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.result.contacts import contacts, peak
from impactlab.fem3d.solver.stepping.history import Energies, History
from impactlab.model.impact import Impact
from impactlab.variables import STATUS_FLAGS

_IMBALANCE = 0.05
"""Largest imbalance of energy, over the initial kinetic energy, at which answers are given."""


def responses(history: History, impact: Impact, pause: float) -> tuple[dict[str, float], int]:
    """Answers by the names of dataset.RESPONSES, NaN where there is none, and their status.

    pause: see contacts.contacts. Those of the fields are in fields.py.
    """
    time, force, sphere, pole, axis, top, velocity = history.table()
    touches = contacts(time, force, pause)
    error = energy_error(history.energies, impact)
    answers = _of_contact(time, force, touches)
    answers |= _of_indentation(time, sphere - axis)
    answers |= _of_deflection(time, axis)
    answers |= _of_rebound(touches, time, velocity, axis, impact)
    answers["permanent_indentation"] = _left(touches, time, (top - axis) + (sphere - pole))
    if np.isnan(answers["maximum_indentation"]):  # the force may go on rising with it
        answers["peak_force"] = answers["time_of_peak_force"] = np.nan
    reasons = [name for name, value in _CAUSES.items() if np.isnan(answers[value])]
    if not error <= _IMBALANCE:
        reasons = ["diverged" if np.isnan(error) else "energy_out_of_balance"]
        answers = dict.fromkeys(answers, np.nan)
    bits = sum(STATUS_FLAGS[name][0] for name in reasons)
    return answers | {"energy_error": error}, bits


_CAUSES = {
    "first_contact_unfinished": "contact_duration",
    "in_contact_at_end": "total_contact_time",
    "sphere_not_leaving": "rebound_velocity",
    "deflection_still_growing": "maximum_deflection",
    "indentation_still_growing": "maximum_indentation",
}
"""Flags of status, and an answer that is missing because of each."""


def energy_error(energies: list[Energies], impact: Impact) -> float:
    """Largest imbalance of energy over the initial kinetic energy; NaN where it is not finite."""
    first = 0.5 * impact.sphere.total_mass * impact.velocity**2
    balances = np.array([entry.balance for entry in energies] or [np.nan])
    error = float(np.max(np.abs(balances - first)) / first)
    return error if np.isfinite(error) else np.nan


def _of_contact(time: Floats, force: Floats, touches: Floats) -> dict[str, float]:
    at, largest = peak(time, force)
    first = float(touches[0, 1] - touches[0, 0]) if len(touches) else np.nan
    total = float(np.sum(touches[:, 1] - touches[:, 0])) if len(touches) else np.nan
    return {
        "peak_force": largest,
        "time_of_peak_force": at,
        "contact_duration": first,
        "number_of_contacts": float(len(touches)),
        "total_contact_time": total,
        "impulse": np.nan if np.isnan(total) else float(_impulse(time, force)),
    }


def _impulse(time: Floats, force: Floats) -> float:
    """N s: each force acts from the middle of the step before to that of the step after."""
    middles = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    return float(np.sum(force * np.diff(middles)))


def _of_indentation(time: Floats, indentation: Floats) -> dict[str, float]:
    at, largest = peak(time, indentation)
    return {"maximum_indentation": np.nan if at >= time[-1] else largest}


def _of_deflection(time: Floats, axis: Floats) -> dict[str, float]:
    at, largest = peak(time, axis)
    return {"maximum_deflection": np.nan if at >= time[-1] else largest}


def _of_rebound(
    touches: Floats, time: Floats, velocity: Floats, axis: Floats, impact: Impact
) -> dict[str, float]:
    """Once the sphere moves upwards and away from the beam."""
    missing = {"rebound_velocity": np.nan, "restitution": np.nan}
    if len(touches) == 0 or np.isnan(touches[-1, 1]) or velocity[-1] >= 0.0:
        return missing
    if velocity[-1] >= (axis[-1] - axis[-2]) / (time[-1] - time[-2]):
        return missing
    rebound = -float(np.interp(touches[-1, 1], time, velocity))
    return {"rebound_velocity": rebound, "restitution": rebound / impact.velocity}


def _left(touches: Floats, time: Floats, dent: Floats) -> float:
    """Mean of the surfaces' dents in m since the last contact: vibrations cancel."""
    if len(touches) == 0 or np.isnan(touches[-1, 1]):
        return float(np.nan)
    return float(np.mean(dent[time > touches[-1, 1]]))
