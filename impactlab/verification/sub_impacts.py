"""One impact, several contacts: each one's times and peak force against the modal series."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import elastic, timoshenko_impact
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    relative,
)
from impactlab.verification.solutions.modal import ModalSolution, solve

_GRID = Discretisation(nodes=801, points=3)
_SAMPLES = 4001
TIME_TOLERANCE, PEAK_TOLERANCE = 1e-4, 1e-3


class Contact(NamedTuple):
    """One contact: begin and end in s, largest force in N."""

    begin: float
    end: float
    peak: float


def timoshenko_spheres() -> dict[str, tuple[Impact, float]]:
    """Return Timoshenko's two spheres at 10 mm/s, and how long (s) each is to be followed.

    The larger one touches three times. His numbers are at second hand: see timoshenko_impact.
    """
    small = elastic(timoshenko_impact())
    large = replace(
        small,
        sphere=replace(small.sphere, radius=0.02),
        beam=replace(small.beam, span=0.307),
    )
    return {
        "sphere of 10 mm radius, span of 153.5 mm": (small, 1e-3),
        "sphere of 20 mm radius, span of 307 mm": (large, 6e-3),
    }


def check_sub_impacts() -> Finding:
    """Compare number, times and peak force of the contacts, and the time in contact."""
    found: list[Comparison] = []
    panels: list[Panel] = []
    for where, (impact, duration) in timoshenko_spheres().items():
        series = solve(impact, duration)
        ours = simulate(impact, _GRID, duration=duration, samples=_SAMPLES)
        found += _compare(where, ours, series)
        panels.append(_panel(where, ours, series))
    return Finding(found, panels)


SUB_IMPACTS = Check(
    "sub_impacts",
    "Sub-impacts",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198, his two spheres; series in "
    "impactlab.verification.solutions.modal",
    check_sub_impacts,
)


def _compare(where: str, ours: xr.Dataset, series: ModalSolution) -> list[Comparison]:
    mine = contacts(ours.time.values, ours.indentation.values, ours.contact_force.values)
    theirs = contacts(series.time, series.indentation, series.contact_force)
    in_contact = sum(contact.end - contact.begin for contact in theirs)
    count, total = ours.number_of_contacts.item(), ours.total_contact_time.item()
    found = [
        absolute("number of contacts", where, "1", count, len(theirs), 0.5),
        relative("total time in contact", where, "s", total, in_contact, TIME_TOLERANCE),
    ]
    for number, (one, other) in enumerate(zip(mine, theirs, strict=False), 1):
        place = f"{where}, contact {number}"
        if number > 1:
            found.append(relative("begin", place, "s", one.begin, other.begin, TIME_TOLERANCE))
        found.append(relative("end", place, "s", one.end, other.end, TIME_TOLERANCE))
        found.append(relative("peak force", place, "N", one.peak, other.peak, PEAK_TOLERANCE))
    return found


def contacts(time: Floats, indentation: Floats, force: Floats) -> list[Contact]:
    """Find the contacts in histories (s, m, N) of shape (time,), between the samples.

    The last one must have ended.
    """
    delta, push = CubicSpline(time, indentation), CubicSpline(time, force)
    roots = delta.roots(extrapolate=False)
    ends = np.append(0.0, roots[roots > 0.5 * time[1]])  # first touch is at 0
    turns = push.derivative().roots(extrapolate=False)
    found = []
    for begin, end in ends.reshape(-1, 2):
        peaks = push(turns[(turns > begin) & (turns < end)])
        found.append(Contact(float(begin), float(end), float(np.max(peaks))))
    return found


def _panel(where: str, ours: xr.Dataset, series: ModalSolution) -> Panel:
    time = ours.time.values
    return Panel(
        where,
        ("time", "s"),
        ("contact force", "N"),
        [
            Curve(f"{_GRID.nodes} nodes", time, ours.contact_force.values),
            Curve("modal series", time, series.at("contact_force", time), independent=True),
        ],
    )
