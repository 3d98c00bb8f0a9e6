"""Responses of a run: of its histories and of its fields, and `status`, the reason for each NaN."""

import numpy as np
import xarray as xr

from impactlab.fem3d.solver.march import History
from impactlab.fem3d.solver.material import ALONG, PEEQ
from impactlab.fem3d.solver.mesh import BEAM, Mesh
from impactlab.fem3d.solver.system import Group
from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.variables import SHORT_PAUSE, STATUS_FLAGS

_CAUSES = {
    "first_contact_unfinished": "contact_duration",
    "in_contact_at_end": "total_contact_time",
    "sphere_not_leaving": "rebound_velocity",
    "deflection_still_growing": "maximum_deflection",
    "indentation_still_growing": "maximum_indentation",
}
"""Flags of status, and a response that is missing because of each."""


def responses(history: History, impact: Impact, pause: float) -> tuple[dict[str, float], int]:
    """Return the responses of the histories by name, NaN where missing, and their status.

    pause: see contacts. Those of the fields are in plastic_responses.
    """
    time, _, _, _, axis, _, velocity = history.table()
    answers, end = history_responses(history, pause)
    rebound = np.nan
    # The sphere moves upwards, and away from the beam.
    if velocity[-1] < min(0.0, (axis[-1] - axis[-2]) / (time[-1] - time[-2])):
        rebound = -float(np.interp(end, time, velocity))
    answers |= {"rebound_velocity": rebound, "restitution": rebound / impact.velocity}
    reasons = [flag for flag, name in _CAUSES.items() if np.isnan(answers[name])]
    first = 0.5 * impact.sphere.total_mass * impact.velocity**2
    balances = np.array([entry.balance for entry in history.energies] or [np.nan])
    error = float(np.max(np.abs(balances - first)) / first)
    if not error <= 0.05:  # of the initial kinetic energy
        reasons = ["energy_out_of_balance" if np.isfinite(error) else "diverged"]
        answers = dict.fromkeys(answers, np.nan)
    answers["energy_error"] = error if np.isfinite(error) else np.nan
    return answers, sum(STATUS_FLAGS[name][0] for name in reasons)


def history_responses(history: History, pause: float) -> tuple[dict[str, float], float]:
    """Return the responses of contact, indentation and deflection by name, NaN where missing.

    Also returns the end of the last contact in s, NaN where there is none. pause: see contacts.
    """
    time, force, sphere, pole, axis, top, _ = history.table()
    touches = contacts(time, force, pause)
    lasting = touches[:, 1] - touches[:, 0] if len(touches) else np.array([np.nan])
    end = float(touches[-1, 1]) if len(touches) else np.nan
    peak_time, largest = peak(time, force)
    indented_at, indentation = peak(time, sphere - axis)
    deflected_at, deflection = peak(time, axis)
    # Each force acts from mid-step to mid-step.
    middles = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    impulse = np.nan if np.isnan(end) else float(np.sum(force * np.diff(middles)))
    dents = ((top - axis) + (sphere - pole))[time > end]
    growing = indented_at >= time[-1]  # the force may go on rising with it
    return {
        "peak_force": np.nan if growing else largest,
        "time_of_peak_force": np.nan if growing else peak_time,
        "contact_duration": first_duration(touches) if len(touches) else np.nan,
        "number_of_contacts": float(len(touches)),
        "total_contact_time": float(np.sum(lasting)),
        "impulse": impulse,
        "mean_force": impulse / float(np.sum(lasting)),
        "maximum_indentation": np.nan if growing else indentation,
        "permanent_indentation": float(np.mean(dents)) if dents.size else np.nan,
        "maximum_deflection": np.nan if deflected_at >= time[-1] else deflection,
    }, end


def contacts(time: Floats, force: Floats, pause: float) -> Floats:
    """Start and end of each contact in s, (contacts, 2); the end is NaN where the run ends first.

    time, force: (steps,) in s and N. pause: a force that returns within it (s) is of the same
    contact: surface waves part single nodes for a moment. Between steps the force falls on along
    the line through its last two values.
    """
    on = np.flatnonzero(force > 0.0)
    if on.size == 0:
        return np.empty((0, 2))
    breaks = np.flatnonzero(np.diff(time[on]) > pause)
    first, last = on[np.append(0, breaks + 1)], on[np.append(breaks, on.size - 1)]
    before = np.maximum(last - 1, 0)
    fall, share = force[before] - force[last], np.ones(last.size)
    np.divide(force[last], fall, out=share, where=fall > 0.0)
    ends = time[last] + (time[last] - time[before]) * np.minimum(share, 1.0)
    if time[-1] - time[on[-1]] <= pause:
        ends[-1] = np.nan
    starts = np.where(first == 0, 0.0, time[first])
    return np.stack([starts, ends], axis=1)


def first_duration(touches: Floats) -> float:
    """Return the duration in s of the first contact of the beam models, from those of `contacts`.

    A pause shorter than SHORT_PAUSE of it is a part of it.
    """
    end = float(touches[0, 1])
    for start, later in touches[1:]:
        if start >= (1.0 + SHORT_PAUSE) * end:
            break
        end = float(later)
    return end - float(touches[0, 0])


def peak(time: Floats, values: Floats) -> tuple[float, float]:
    """Return time and size of the largest value, on the parabola through it and its neighbours."""
    largest = int(np.argmax(values))
    if largest in (0, values.size - 1):
        return float(time[largest]), float(values[largest])
    t, y = time[largest - 1 : largest + 2] - time[largest], values[largest - 1 : largest + 2]
    curve, slope, top = np.polyfit(t, y, 2)
    if curve >= 0.0:
        return float(time[largest]), float(values[largest])
    shift = float(np.clip(-0.5 * slope / curve, t[0], t[2]))
    return float(time[largest]) + shift, float(top + 0.5 * slope * shift)


PLASTIC_ZONE_STRAIN = 1e-5  # PEEQ from which on a section counts as plastic, as in the beam models


def fields(groups: list[Group], count: int) -> dict[str, Floats]:
    """Return fields per element, (count,): means over its integration points, and the largest PEEQ.

    equivalent_plastic_strain, largest_equivalent_plastic_strain, plastic_strain (along the beam):
    1. von_mises_stress: Pa.
    """
    result: dict[str, Floats] = {}
    for group in groups:
        strain, s = group.of_points(PEEQ), group.deviators.swapaxes(0, 1)
        squares = np.sum(s[:3] ** 2, axis=0) + 2.0 * np.sum(s[3:] ** 2, axis=0)
        for name, values in {
            "equivalent_plastic_strain": strain.mean(axis=0),
            "largest_equivalent_plastic_strain": strain.max(axis=0),
            "plastic_strain": group.of_points(ALONG).mean(axis=0),
            "von_mises_stress": np.sqrt(1.5 * squares).mean(axis=0),
        }.items():
            result.setdefault(name, np.empty(count))[group.elements] = values
    return result


def plastic_responses(mesh: Mesh, impact: Impact, strain: Floats) -> dict[str, float]:
    """Return the responses of the beam's PEEQ by name.

    strain: each element's largest. And sphere_plastic_strain, and one_point_plastic_strain: where
    bending is not integrated over an element.
    """
    points = mesh.nodes[mesh.elements, 0]
    beam = mesh.body == BEAM
    coarse = strain[~mesh.full]
    remote = beam & (np.abs(points.mean(axis=1)) > impact.beam.depth)
    plastic = points[beam & (strain > PLASTIC_ZONE_STRAIN)]
    ends = np.stack([plastic.min(axis=1), plastic.max(axis=1)], axis=1)  # of lengths of the beam
    ends = np.unique(np.round(ends, 12), axis=0)
    return {
        "peak_plastic_strain": float(strain[beam].max()),
        "remote_plastic_strain": float(strain[remote].max(initial=0.0)),
        "sphere_plastic_strain": float(strain[~beam].max(initial=0.0)),
        "one_point_plastic_strain": float(coarse.max(initial=0.0)),
        "plastic_zone_length": float(0.5 * mesh.copies * np.sum(ends[:, 1] - ends[:, 0])),
    }


LIMIT = 0.002  # PEEQ at the border of the zone: the strain of the usual proof stress


def plastic_reach(run: xr.Dataset, along: int, limit: float = LIMIT) -> float:
    """Return how far from the impact's centre the PEEQ of the beam exceeds `limit`, in m.

    run: as solve gives it. along: 0, the beam on its struck surface; 2, the depth below it; both
    at mid-width, on the side of the impact where that is farther. In the shape before the impact:
    the outermost place where the line through the means of the elements comes down to the limit; 0
    where none is above it, the last element's middle where all are.
    """
    points = run["node_position"].values[run["element_nodes"].values]
    edge, x = 1e-6 * float(run["element_size"]), points[:, :, 0]
    row = (run["body"].values == BEAM) & (points[:, :, 1].min(axis=1) < edge)
    if along == 0:
        row &= points[:, :, 2].max(axis=1) > -edge
    else:
        row &= np.abs(x).min(axis=1) < edge
    beyond = x.mean(axis=1) > 0.0
    strain = run["equivalent_plastic_strain"].values
    sides = [
        (np.abs(points[side, :, along].mean(axis=1)), strain[side])
        for side in (row & beyond, row & ~beyond)
        if side.any()
    ]
    return max(_reach(*side, limit) for side in sides)


def _reach(reach: Floats, strain: Floats, limit: float) -> float:
    """Return where the strain of elements that far away, in m, comes down to the limit."""
    order = np.argsort(reach)
    reach, strain = reach[order], strain[order]
    above = np.flatnonzero(strain > limit)
    if not above.size:
        return 0.0
    last = int(above[-1])
    if last + 1 == reach.size:
        return float(reach[last])
    share = (strain[last] - limit) / (strain[last] - strain[last + 1])
    return float(reach[last] + share * (reach[last + 1] - reach[last]))
