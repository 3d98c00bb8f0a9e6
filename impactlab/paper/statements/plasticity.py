"""Statements on the plastic strain (PEEQ) of the beam, after two times and at two places."""

from __future__ import annotations

import numpy as np

from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    finest_grid,
    response_curve,
    runs_of,
    verdict,
)

LIMIT = 0.002
"""The plastic strain that the paper compares with."""
LATE, EARLY = "fig10_nodes", "fig10_first"
"""Studies: after all contacts, and after the first."""
ELASTIC_UP_TO = 5.0
BELOW_LIMIT_AT = 10.0
ABOVE_LIMIT_AT = (15.0, 20.0)
FIRST_YIELD_BETWEEN = (5.0, 10.0)
"""Velocities in the statements, m/s."""
AWAY = (
    (
        "away from the impact, after all contacts (25 ms)",
        LATE,
        "remote_plastic_strain",
        True,
    ),
    ("away from the impact, after 1 ms", EARLY, "remote_plastic_strain", False),
)
"""Readings: words, study, response, whether it is the literal one. Away is farther than one beam
depth from the impact: the paper does not say how far, nor when."""
ANYWHERE = (
    ("anywhere in the beam, after all contacts (25 ms)", LATE, "peak_plastic_strain", False),
    ("anywhere in the beam, after 1 ms", EARLY, "peak_plastic_strain", False),
)
"""The whole beam, with the zone under the sphere."""


def _judge_elastic(case: str, data: Data, study: str, response: str, literal: bool) -> Judgement:
    curve = response_curve(data, study, response)
    low = curve.velocity <= ELASTIC_UP_TO
    if curve.velocity[low].max(initial=0.0) < ELASTIC_UP_TO:
        raise UnknownError(f"the study {study} has no run at {ELASTIC_UP_TO:g} m/s")
    worst = int(curve.high[low].argmax())
    largest = curve.number(worst, f"largest PEEQ up to {ELASTIC_UP_TO:g} m/s", "1")
    stands = largest.high == 0.0
    why = "No fibre there yields on any grid."
    if not stands:
        why = f"Some fibre there yields at {curve.velocity[worst]:g} m/s."
    return Judgement(case, (largest,), verdict(stands, literal=literal), why)


ELASTIC_TO_5 = Statement(
    "elastic_to_5",
    text="Up to 5 m/s there is no plastic strain away from the impact.",
    test="PEEQ + U = 0 farther than one beam depth from mid-span, at every velocity up to 5 m/s.",
    judge_case=_judge_elastic,
    cases=AWAY,
    studies=(LATE, EARLY),
)


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
    return Judgement(case, (strain,), verdict(under is below, literal=literal), why)


BELOW_LIMIT_AT_10 = Statement(
    "below_limit_at_10",
    text="At 10 m/s the plastic strain along the beam stays below 0.2 %.",
    test=(
        "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %, and cannot be judged in "
        "between."
    ),
    judge_case=_judge_limit,
    cases=tuple((*reading, BELOW_LIMIT_AT, True) for reading in (*AWAY, *ANYWHERE)),
    studies=(LATE, EARLY),
)
ABOVE_LIMIT_AT_15 = Statement(
    "above_limit_at_15",
    text="At 15 and 20 m/s the plastic strain is above 0.2 % away from the impact, too.",
    test=(
        "PEEQ − U > 0.2 % farther than one beam depth from mid-span; it does not hold where "
        "PEEQ + U < 0.2 %, and cannot be judged in between."
    ),
    judge_case=_judge_limit,
    cases=tuple(
        (f"{velocity:g} m/s, {words}", *reading, velocity, False)
        for velocity in ABOVE_LIMIT_AT
        for words, *reading in AWAY
    ),
    studies=(LATE, EARLY),
)


def _judge_first_yield(
    case: str, data: Data, study: str, response: str, literal: bool
) -> Judgement:
    curve = response_curve(data, study, response)
    first = int(np.argmax(curve.value > 0))
    if first == 0:  # no strain anywhere, or strain from the lowest velocity on
        raise UnknownError(f"the velocities of {study} do not enclose the first yield")
    below, above = float(curve.velocity[first - 1]), float(curve.velocity[first])
    found = Number("velocity at first yield", 0.5 * (below + above), "m s-1", 0.5 * (above - below))
    low, high = FIRST_YIELD_BETWEEN
    stands = low <= below and above <= high
    why = f"No plastic strain at {below:g} m/s, some at {above:g} m/s."
    return Judgement(case, (found,), verdict(stands, literal=literal), why)


PLASTICITY_BEGINS = Statement(
    "plasticity_begins",
    text="Plasticity outside the contact begins between 5 and 10 m/s.",
    test=(
        "The largest velocity with PEEQ = 0 and the smallest with PEEQ > 0 both lie from 5 to 10 "
        "m/s. The uncertainty is half of the gap between the two, on the finest grid."
    ),
    judge_case=_judge_first_yield,
    cases=(*AWAY, *ANYWHERE),
    studies=(LATE, EARLY),
)
