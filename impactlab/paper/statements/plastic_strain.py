"""Statements on the plastic strain (PEEQ) along the beam: when it begins, where, and how large."""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.wing import SOLID
from impactlab.model.impact import paper_impact
from impactlab.paper.statements.statement import (
    Assessment,
    Case,
    Data,
    Number,
    Ruling,
    Statement,
    UnknownError,
    finest_grid,
    judged,
    response_curve,
    runs_of,
    select_response,
    statement,
    uncertain,
)

LATE, EARLY = "fig10_nodes", "fig10_first"  # studies: after all contacts, and after the first one
SOLID_STUDY = "witness"  # the study of beam and 3-D models over the velocities
PROFILES = ("fig10_fine", "fig10", "fig10_coarse")
"""Studies of the strain along the beam after all contacts, the finest grid first."""
LIMIT = 0.002  # the plastic strain that the paper compares with
AWAY = (
    ("after all contacts (25 ms)", LATE, "remote_plastic_strain", True),
    ("after 1 ms", EARLY, "remote_plastic_strain", False),
)
"""Words, study, response, whether it is the literal one. The response is that farther than one beam
depth from the impact.
"""
DISTANCES = (0.5, 1.0, 1.25, 1.5, 2.0)
"""Where "away from the impact" may begin, in beam depths: the paper does not say."""
_HOW_FAR = (
    "The paper does not say where “away” begins: a row per distance, in beam depths H. U: the grid "
    "convergence index of three grids, or three times their range."
)


@statement(
    text="Up to 5 m/s there is no plastic strain away from the impact.",
    test="PEEQ + U = 0 farther than one beam depth from mid-span, at every velocity up to 5 m/s.",
    cases=AWAY,
    studies=(LATE, EARLY),
)
def elastic_to_5(data: Data, study: str, response: str, literal: bool) -> Assessment:
    """Judge the largest strain up to 5 m/s."""
    largest = _largest_to_5(data, study, response)
    elastic = "No fibre there yields on any grid."
    yields = "Some fibre there yields."
    return judged((largest,), largest.high == 0.0, elastic, yields, literal=literal)


def _largest_to_5(data: Data, study: str, response: str) -> Number:
    """Return the largest value of a strain up to 5 m/s."""
    curve = response_curve(data, study, response)
    low = [velocity for velocity in curve if velocity <= 5.0]
    if max(low, default=0.0) < 5.0:
        raise UnknownError(f"the study {study} has no run at 5 m/s")
    worst = max(low, key=lambda velocity: curve[velocity].high)
    return replace(curve[worst], name=f"largest PEEQ up to 5 m/s (at {worst:g} m/s)")


@statement(
    text="From 0 to 5 m/s the highest peak of plastic strain lies under the impact (figure 10).",
    test=(
        "There is a peak: the largest PEEQ of the beam, less U, is above 0. In the paper's model "
        "the strain is that of bending, and the contact yields in no fibre. In the 3-D model, "
        "where it does, PEEQ is above 0, and is 0 farther than one beam depth from the impact."
    ),
    cases=(
        *(
            (f"in the paper's model, {place}", study, "peak_plastic_strain", literal)
            for place, study, _, literal in AWAY
        ),
        ("in the 3-D model, after the first contact", SOLID_STUDY, "", False),
    ),
    studies=(LATE, EARLY, SOLID_STUDY),
)
def peak_under_impact(data: Data, study: str, response: str, literal: bool) -> Assessment:
    """Judge whether any fibre, or element about the contact, yields up to 5 m/s."""
    if study == SOLID_STUDY:
        return _solid_peak(data)
    largest = _largest_to_5(data, study, response)
    none = "No fibre yields on any grid: the curves are zero, and have no peak."
    return judged((largest,), largest.low > 0.0, "Some fibre yields.", none, literal=literal)


def _solid_peak(data: Data) -> Assessment:
    """Judge the 3-D model's runs up to 5 m/s, on every mesh."""
    runs = runs_of(data, SOLID_STUDY)
    low = [float(v) for v in runs["velocity"].values if v <= 5.0]
    peaks, remotes = (
        select_response(runs, name, velocity=low, beam_model=SOLID)
        for name in ("peak_plastic_strain", "remote_plastic_strain")
    )
    numbers = (
        Number("least of the largest PEEQ", float(peaks.min()), "1", np.nan, percent=True),
        Number("largest PEEQ beyond one depth", float(remotes.max()), "1", percent=True),
    )
    stands = float(peaks.min()) > 0.0 == float(remotes.max())
    why = "All that yields lies about the contact."
    return judged(numbers, stands, why, "Something else yields, or nothing.", literal=False)


def _profile(data: Data, study: str, velocity: float) -> tuple[Any, Any]:
    """Return distances from mid-span in m and the largest PEEQ over the depth there, (nodes,)."""
    runs = runs_of(data, study)
    try:
        chosen = runs["equivalent_plastic_strain"].sel(velocity=velocity)
    except KeyError:
        raise UnknownError(f"the study {study} keeps no profile at {velocity:g} m/s") from None
    strain = chosen.max("z", skipna=False).values
    if not np.isfinite(strain).all():
        raise UnknownError(f"the run at {velocity:g} m/s of the study {study} failed")
    x = chosen["x"].values
    return np.abs(x - 0.5 * (x[0] + x[-1])), strain


def _strain_beyond(data: Data, velocity: float, depths: float) -> Number:
    """Return the largest PEEQ farther than so many beam depths from mid-span, with U."""
    values, nodes = [], []
    for study in PROFILES:
        distance, strain = _profile(data, study, velocity)
        # Between two nodes the strain is linear: the place is the same on every grid.
        order = np.argsort(distance, kind="stable")
        reach = depths * paper_impact().beam.depth
        edge = float(np.interp(reach, distance[order], strain[order]))
        values.append(max(edge, float(strain[distance > reach].max())))
        nodes.append(distance.size)
    by_grid = xr.DataArray(values, {"nodes": nodes}, "nodes")
    return Number("PEEQ", values[0], "1", uncertain(by_grid), percent=True)


def _judge_limit(
    data: Data, velocity: float, place: float | tuple[str, str], literal: bool, below: bool
) -> Assessment:
    """Judge the strain below the limit, or above it; unknown where U encloses the limit."""
    if isinstance(place, tuple):
        study, response = place
        number = finest_grid(runs_of(data, study), response, velocity=velocity)
        strain = replace(number, name="PEEQ", percent=True)
    else:  # beyond so many beam depths, after all contacts
        strain = _strain_beyond(data, velocity, place)
    if not np.isfinite(strain.uncertainty):
        raise UnknownError("fewer than three grids give no uncertainty")
    under, over = strain.high < LIMIT, strain.low > LIMIT
    if not (under or over):
        why = (
            "The limit lies within the uncertainty: a perfectly plastic hinge has no limit in the "
            "nodes. Runs with the steel's hardening, which the paper does not give, would decide."
        )
        return Assessment((strain,), Ruling.UNKNOWN, why)
    side = "below" if under else "above"
    why = f"{100 * strain.value:.2g} % lies {side} the limit by more than its uncertainty."
    return judged((strain,), under is below, why, literal=literal)


def _limit_cases(velocity: float, below: bool, everywhere: bool) -> tuple[Case, ...]:
    """Return the cases of a velocity; everywhere: the paper's words include the place under it."""
    rows: list[tuple[str, Any, bool]] = []
    if everywhere:
        early = EARLY, "peak_plastic_strain"
        rows.append(("anywhere in the beam", 0.0, True))
        rows.append(("anywhere in the beam, 1 ms after first touch", early, False))
    for depths in DISTANCES:
        rows.append((f"beyond {depths:g} H from the impact", depths, False))
    early = EARLY, "remote_plastic_strain"
    rows.append(("beyond 1 H, 1 ms after first touch", early, False))
    return tuple((f"{velocity:g} m/s, {case}", velocity, *row, below) for case, *row in rows)


def _strain_statement(name: str, text: str, criterion: str, cases: tuple[Case, ...]) -> Statement:
    test = f"{criterion} PEEQ: the largest over the depth, 25 ms after first touch. {_HOW_FAR}"
    return Statement(name, _judge_limit, text, test, cases, (*PROFILES, EARLY))


below_limit_at_10 = _strain_statement(
    "below_limit_at_10",
    "At 10 m/s the plastic strain along the beam stays below 0.2 %.",
    "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %.",
    _limit_cases(10.0, True, True),
)
below_limit_at_15 = _strain_statement(
    "below_limit_at_15",
    "At 15 m/s, one half of the sentence: the plastic strain is less than 0.2 % throughout.",
    "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %.",
    _limit_cases(15.0, True, True),
)
above_limit_at_15 = _strain_statement(
    "above_limit_at_15",
    "At 15 m/s, the other half, and at 20 m/s: above 0.2 % at points away from the impact, too.",
    "PEEQ − U > 0.2 %; it does not hold where PEEQ + U < 0.2 %.",
    (*_limit_cases(15.0, False, False), *_limit_cases(20.0, False, False)),
)


@statement(
    text="Plasticity outside the contact begins between 5 and 10 m/s.",
    test=(
        "The largest velocity with PEEQ = 0 and the smallest with PEEQ > 0 both lie from 5 to 10 "
        "m/s. The uncertainty is half of the gap between the two, on the finest grid."
    ),
    cases=AWAY,
    studies=(LATE, EARLY),
)
def plasticity_begins(data: Data, study: str, response: str, literal: bool) -> Assessment:
    """Judge the velocities that enclose the first yield farther than a depth from the impact."""
    curve = response_curve(data, study, response)
    first = int(np.argmax([number.value > 0 for number in curve.values()]))
    if first == 0:  # no strain anywhere, or strain from the lowest velocity on
        raise UnknownError(f"the velocities of {study} do not enclose the first yield")
    below, above = list(curve)[first - 1 : first + 1]
    onset = Number("velocity at first yield", 0.5 * (below + above), "m s-1", 0.5 * (above - below))
    why = f"No plastic strain at {below:g} m/s, some at {above:g} m/s."
    return judged((onset,), below >= 5.0 and above <= 10.0, why, literal=literal)
