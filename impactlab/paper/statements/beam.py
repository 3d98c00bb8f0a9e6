"""Statements on the beam model alone: convergence, and responses against the velocity.

The responses are contact duration, permanent indentation, and the plastic strain (PEEQ) of the
beam, after two times and at two places.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from impactlab.analysis.convergence.judgement import judge as judge_convergence
from impactlab.analysis.verdicts import TOLERANCE
from impactlab.paper.statements.statement import (
    Case,
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    finest_grid,
    judged,
    response_curve,
    runs_of,
    select_response,
    statement,
)

NODES_STUDY, POINTS_STUDY = "fig06_nodes", "fig06_points"
VELOCITIES = (0.99, 15.0)
"""Without and with yielding fibres, m/s."""
MOTION = ("peak_force", "contact_duration", "maximum_indentation", "maximum_deflection")
"""Responses that the paper's histories show."""
STRAIN = ("peak_plastic_strain", "remote_plastic_strain")
"""Responses of plastic strain, which converge in their own way or not at all."""
PRINTED_NODES = 601
READINGS_OF_P = (
    ("two Lobatto points over the depth (as printed)", "lobatto", 2, True),
    (
        "two Lobatto points over half the depth, the axis one of them (3 in all)",
        "lobatto",
        3,
        False,
    ),
    ("two Lobatto points in each half of the depth (4 in all)", "lobatto", 4, False),
    ("two Gauss points over the depth", "legendre", 2, False),
)
"""Readings of P = 2: words, rule, points over the whole depth, whether it is the literal one."""


def _response_groups(data: Data, study: str) -> Iterator[Case]:
    """Yield words, velocity and a group of responses; strains only where a fibre yields."""
    for velocity in VELOCITIES:
        yield f"{velocity:g} m/s, force and motion", velocity, MOTION
        strains = data[study].get("peak_plastic_strain") if study in data else None
        if strains is None or (strains.where(strains["velocity"] == velocity) > 0).any():
            yield f"{velocity:g} m/s, plastic strain (PEEQ)", velocity, STRAIN


@statement(
    text="N = 601 nodes are the least for convergence.",
    test=(
        "For every response f: |f(601) − f∞| + U ≤ 1 % of f∞, and no smaller N of the study does "
        "as well. f∞: Richardson's value, or the value with the most nodes where there is none; "
        "U: its uncertainty (grid convergence index). Plastic strain (PEEQ) is judged separately."
    ),
    cases=partial(_response_groups, study=NODES_STUDY),
    studies=(NODES_STUDY,),
)
def nodes_suffice(case: str, data: Data, velocity: float, names: tuple[str, ...]) -> Judgement:
    """Judge 601 nodes by the error of each response."""
    errors, needed = zip(*(_nodes_error(data, velocity, name) for name in names), strict=True)
    highest = [error.high for error in errors]
    worst, least = names[int(np.argmax(highest))].replace("_", " "), max(needed)
    numbers = (*errors, Number("least nodes for all of them", least, "1"))
    beyond = f"With {PRINTED_NODES} nodes the {worst} is not known within {100 * TOLERANCE:g} %."
    why = "Every smaller number of nodes in the study falls short."
    if not (exact := least == PRINTED_NODES):
        why = f"Read as “{PRINTED_NODES} are enough”: {least:g} already are."
    return judged(case, numbers, not max(highest) > TOLERANCE, why, beyond, literal=exact)


def _nodes_error(data: Data, velocity: float, name: str) -> tuple[Number, float]:
    """Return the relative error at N = 601, and the least N from which on it is in tolerance."""
    runs = runs_of(data, NODES_STUDY)
    where = {"velocity": velocity, "points": int(runs["points"].max())}
    values = select_response(runs, name, **where).sortby("nodes", ascending=False)
    finest = finest_grid(runs, name, **where)
    limit = judge_convergence(values.values.astype(float), 1.0 / (values["nodes"].values - 1.0))
    reference = limit.extrapolated if np.isfinite(limit.extrapolated) else finest.value
    share = finest.uncertainty / abs(reference) if reference else 0.0 if not finest.high else np.inf
    error = abs(values - reference) / (abs(reference) or 1.0)
    within = (error + share <= TOLERANCE).values
    count = int(np.argmin(within)) if not within.all() else within.size
    least = float(values["nodes"].values[count - 1]) if count else np.inf
    at = float(error.sel(nodes=PRINTED_NODES))
    return Number(f"error of the {name.replace('_', ' ')}", at, "1", share, percent=True), least


def _points_cases(data: Data) -> Iterator[Case]:
    for reading, rule, points, literal in READINGS_OF_P:
        for words, velocity, names in _response_groups(data, POINTS_STUDY):
            where = {"velocity": velocity, "rule": rule}
            yield f"{reading}; {words}", where, points, names, literal


@statement(
    text="P = 2 integration points over the depth are the least for convergence.",
    test=(
        "For every response f: |f(P) − f(most)| + U ≤ 1 % of f(most), at 601 nodes. U: the change "
        "of f between the most points and the next fewer. The paper does not say which points P "
        "counts: every reading has a row."
    ),
    cases=_points_cases,
    studies=(POINTS_STUDY,),
)
def points_suffice(
    case: str, data: Data, where: dict[str, Any], points: int, names: tuple[str, ...], literal: bool
) -> Judgement:
    """Judge a reading of P = 2 by the error of each response."""
    errors = tuple(_points_error(data, where, points, name) for name in names)
    worst = max(errors, key=lambda error: error.high)
    within = worst.high <= TOLERANCE
    beyond = f"The {worst.name} is {100 * worst.value:,.1f} %."
    return judged(case, errors, within, "Every error is within 1 %.", beyond, literal=literal)


def _points_error(data: Data, where: dict[str, Any], points: int, name: str) -> Number:
    """Return the relative error with so many points; infinite where the value should be zero."""
    values = select_response(runs_of(data, POINTS_STUDY), name, **where)
    values = values.sortby("points", ascending=False)
    most, next_fewer = (float(values.isel(points=at)) for at in (0, 1))
    given = float(values.sel(points=points))
    scale = abs(most) or (np.nan if given or next_fewer else 1.0)
    gaps = (abs(value - most) / scale for value in (given, next_fewer))
    error, spread = (np.inf if np.isnan(gap) else float(gap) for gap in gaps)
    return Number(f"error of the {name.replace('_', ' ')}", error, "1", spread, percent=True)


DURATION_STUDY, LATE, EARLY = "fig08", "fig10_nodes", "fig10_first"
"""Studies: over the contact laws, after all contacts, and after the first contact."""
LIMIT = 0.002
"""The plastic strain that the paper compares with."""
READINGS = (
    ("away from the impact, after all contacts (25 ms)", LATE, "remote_plastic_strain", True),
    ("away from the impact, after 1 ms", EARLY, "remote_plastic_strain", False),
    ("anywhere in the beam, after all contacts (25 ms)", LATE, "peak_plastic_strain", False),
    ("anywhere in the beam, after 1 ms", EARLY, "peak_plastic_strain", False),
)
"""Words, study, response, whether it is the literal one. Away is farther than one beam depth from
the impact: the paper does not say how far, nor when. Anywhere includes the zone under the sphere.
"""
AWAY = READINGS[:2]


def _contact_laws(data: Data) -> Iterator[tuple[str, str]]:
    """Yield a case and its contact law for each of the study; "any" where it is not solved."""
    laws = ["any"]
    if DURATION_STUDY in data and "contact" in data[DURATION_STUDY].dims:
        laws = [str(law) for law in data[DURATION_STUDY]["contact"].values]
    for law in laws:
        name = "MJG" if law == "mjg" else law.replace("_", "-").title()
        yield f"{name} contact", law


@statement(
    text="The contact duration falls as the impact velocity rises.",
    test=(
        "t(v₂) + U₂ < t(v₁) − U₁ for every two neighbouring velocities v₁ < v₂; t: duration of the "
        "first contact. The statement holds under a reading where this is so over more than half "
        "of the velocities, from the lowest on."
    ),
    cases=_contact_laws,
    studies=(DURATION_STUDY,),
)
def duration_falls(case: str, data: Data, law: str) -> Judgement:
    """Judge the fall from each velocity to the next."""
    curve = response_curve(data, DURATION_STUDY, "contact_duration", contact=law)
    speeds, found = list(curve), list(curve.values())
    falls = [faster.high < slower.low for slower, faster in pairwise(found)]
    count = [*falls, False].index(False)
    # at the lowest velocity, where the duration stops falling, and at the highest
    numbers = tuple(
        replace(found[at], name=f"contact duration at {speeds[at]:g} m/s")
        for at in dict.fromkeys((0, count, len(falls)))
    )
    case = f"{case}, {speeds[0]:g} to {speeds[-1]:g} m/s"
    if count == len(falls):
        why = f"It falls at every one of the {count} steps."
        return Judgement(case, numbers, Verdict.HOLDS, why)
    last, after = found[count : count + 2]
    change = "rises" if after.low > last.high else "does not fall by more than its uncertainty"
    why = f"It falls up to {speeds[count]:g} m/s and {change} from there to "
    why += f"{speeds[count + 1]:g} m/s"
    merges = after.value > 1.25 * last.value  # a second push with the first
    why += ": the sphere no longer lifts off between two pushes." if merges else "."
    outcome = Verdict.READING if 2 * count > len(falls) else Verdict.FAILS
    return Judgement(case, numbers, outcome, why)


@statement(
    text="The model's contact duration lies above the spring-mass prediction.",
    test=(
        "t(model) − U > t(spring-mass) + U at every velocity, under the same contact law; t: "
        "duration of the first contact. The statement holds under a reading where this is so at "
        "some velocities."
    ),
    cases=_contact_laws,
    studies=(DURATION_STUDY,),
)
def above_spring_mass(case: str, data: Data, law: str) -> Judgement:
    """Judge the durations of both models under the same contact law."""
    if "beam_model" not in runs_of(data, DURATION_STUDY).dims:
        raise UnknownError(f"the study {DURATION_STUDY} does not vary beam_model")
    study = DURATION_STUDY, "contact_duration"
    ours = response_curve(data, *study, contact=law)
    theirs = response_curve(data, *study, contact=law, beam_model="spring_mass")
    higher: list[str] = []
    lower: list[str] = []
    ratios = []
    for (velocity, one), other in zip(ours.items(), theirs.values(), strict=True):
        (higher if one.low > other.high else lower).append(f"{velocity:g}")
        ratio = one.value / other.value
        width = ratio * (one.uncertainty / one.value + other.uncertainty / other.value)
        ratios.append((ratio, width))
    first = itemgetter(0)
    ends = {"smallest": min(ratios, key=first), "largest": max(ratios, key=first)}
    numbers = tuple(
        Number(f"{name} model over spring-mass", ratio, "1", width)
        for name, (ratio, width) in ends.items()
    )
    if not lower:
        return Judgement(case, numbers, Verdict.HOLDS, "It is above at every velocity.")
    if not higher:
        return Judgement(case, numbers, Verdict.FAILS, "It is above at no velocity.")
    why = f"Above at {', '.join(higher)} m/s, not at {', '.join(lower)}."
    return Judgement(case, numbers, Verdict.READING, why)


@statement(
    text="The permanent indentation grows with the impact velocity.",
    test="d(v₂) − U₂ > d(v₁) + U₁ for every two neighbouring velocities v₁ < v₂ of the study.",
    cases=(("Stronge contact, after the last contact",),),
    studies=(LATE,),
)
def dent_grows(case: str, data: Data) -> Judgement:
    """Judge the growth from each velocity to the next."""
    curve = response_curve(data, LATE, "permanent_indentation")
    ends = min(curve), max(curve)
    numbers = tuple(replace(curve[end], name=f"dent at {end:g} m/s") for end in ends)
    steps = [
        f"{slow:g} to {fast:g}"
        for slow, fast in pairwise(curve)
        if not curve[fast].low > curve[slow].high
    ]
    shrinks = f"It does not from {', '.join(steps)} m/s."
    return judged(case, numbers, not steps, "It grows at every step.", shrinks)


@statement(
    text="Up to 5 m/s there is no plastic strain away from the impact.",
    test="PEEQ + U = 0 farther than one beam depth from mid-span, at every velocity up to 5 m/s.",
    cases=AWAY,
    studies=(LATE, EARLY),
)
def elastic_to_5(case: str, data: Data, study: str, response: str, literal: bool) -> Judgement:
    """Judge the largest strain up to 5 m/s."""
    curve = response_curve(data, study, response)
    low = [velocity for velocity in curve if velocity <= 5.0]
    if max(low, default=0.0) < 5.0:
        raise UnknownError(f"the study {study} has no run at 5 m/s")
    worst = max(low, key=lambda velocity: curve[velocity].high)
    largest = replace(curve[worst], name="largest PEEQ up to 5 m/s")
    elastic = "No fibre there yields on any grid."
    yields = f"Some fibre there yields at {worst:g} m/s."
    return judged(case, (largest,), largest.high == 0.0, elastic, yields, literal=literal)


def _judge_limit(
    case: str, data: Data, study: str, response: str, literal: bool, velocity: float, below: bool
) -> Judgement:
    """Judge the strain below the limit, or above it; unknown where U encloses the limit."""
    found = finest_grid(runs_of(data, study), response, velocity=velocity)
    name = f"PEEQ at {velocity:g} m/s"
    strain = Number(name, found.value, "1", found.uncertainty, percent=True)
    if np.isnan(strain.high):
        raise UnknownError(f"no number, or none with an uncertainty: {name}")
    under, over = strain.high < LIMIT, strain.low > LIMIT
    if not (under or over):
        why = f"The limit lies within the uncertainty, {100 * strain.uncertainty:.2g} %."
        return Judgement(case, (strain,), Verdict.UNKNOWN, why)
    side = "below" if under else "above"
    sure = "by more than its uncertainty" if strain.uncertainty else "on every grid"
    why = f"It lies {side} the limit {sure}."
    return judged(case, (strain,), under is below, why, literal=literal)


below_limit_at_10 = Statement(
    "below_limit_at_10",
    _judge_limit,
    text="At 10 m/s the plastic strain along the beam stays below 0.2 %.",
    test=(
        "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %, and cannot be judged in "
        "between."
    ),
    cases=tuple((*reading, 10.0, True) for reading in READINGS),
    studies=(LATE, EARLY),
)
above_limit_at_15 = Statement(
    "above_limit_at_15",
    _judge_limit,
    text="At 15 and 20 m/s the plastic strain is above 0.2 % away from the impact, too.",
    test=(
        "PEEQ − U > 0.2 % farther than one beam depth from mid-span; it does not hold where "
        "PEEQ + U < 0.2 %, and cannot be judged in between."
    ),
    cases=tuple(
        (f"{velocity:g} m/s, {words}", *reading, velocity, False)
        for velocity in (15.0, 20.0)
        for words, *reading in AWAY
    ),
    studies=(LATE, EARLY),
)


@statement(
    text="Plasticity outside the contact begins between 5 and 10 m/s.",
    test=(
        "The largest velocity with PEEQ = 0 and the smallest with PEEQ > 0 both lie from 5 to 10 "
        "m/s. The uncertainty is half of the gap between the two, on the finest grid."
    ),
    cases=READINGS,
    studies=(LATE, EARLY),
)
def plasticity_begins(case: str, data: Data, study: str, response: str, literal: bool) -> Judgement:
    """Judge the velocities that enclose the first yield."""
    curve = response_curve(data, study, response)
    first = int(np.argmax([number.value > 0 for number in curve.values()]))
    if first == 0:  # no strain anywhere, or strain from the lowest velocity on
        raise UnknownError(f"the velocities of {study} do not enclose the first yield")
    below, above = list(curve)[first - 1 : first + 1]
    found = Number("velocity at first yield", 0.5 * (below + above), "m s-1", 0.5 * (above - below))
    why = f"No plastic strain at {below:g} m/s, some at {above:g} m/s."
    return judged(case, (found,), below >= 5.0 and above <= 10.0, why, literal=literal)
