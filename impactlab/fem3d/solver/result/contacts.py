"""When sphere and beam touch: read off the force of each step."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.mesh.mesh import Floats


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
    ends = [_end(time, force, int(step)) for step in last]
    if time[-1] - time[on[-1]] <= pause:
        ends[-1] = np.nan
    starts = np.where(first == 0, 0.0, time[first])
    return np.stack([starts, ends], axis=1)


def _end(time: Floats, force: Floats, last: int) -> float:
    """Where the force after step `last` reaches zero, within the step."""
    step = float(time[last] - time[last - 1]) if last else 0.0
    fall = float(force[last - 1] - force[last]) if last else 0.0
    share = float(force[last]) / fall if fall > 0.0 else 1.0
    return float(time[last]) + step * min(share, 1.0)


def peak(time: Floats, values: Floats) -> tuple[float, float]:
    """Time and size of the largest value, on the parabola through it and its neighbours."""
    at = int(np.argmax(values))
    if at in (0, values.size - 1):
        return float(time[at]), float(values[at])
    t, y = time[at - 1 : at + 2] - time[at], values[at - 1 : at + 2]
    curve, slope, top = np.polyfit(t, y, 2)
    if curve >= 0.0:
        return float(time[at]), float(values[at])
    shift = float(np.clip(-0.5 * slope / curve, t[0], t[2]))
    return float(time[at]) + shift, float(top + 0.5 * slope * shift)
