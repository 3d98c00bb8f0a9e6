"""Statements on the plastic strain (PEEQ) of the beam, after two times and at two places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan

import numpy as np

from impactlab.paper.statements.evidence import Curve, finest_grid, response_curve, runs_of
from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    attempt,
    require_known,
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


@dataclass(frozen=True)
class Reading:
    """A reading of the paper's words: which study and response; literal: the nearest reading."""

    words: str
    study: str
    response: str
    literal: bool = False

    def curve(self, data: Data) -> Curve:
        """Return the largest PEEQ against the velocity; raises UnknownError without the runs."""
        return response_curve(data, self.study, self.response)


AWAY = (
    Reading(
        "away from the impact, after all contacts (25 ms)",
        LATE,
        "remote_plastic_strain",
        literal=True,
    ),
    Reading("away from the impact, after 1 ms", EARLY, "remote_plastic_strain"),
)
"""Farther than one beam depth from the impact: the paper does not say how far, nor when."""
ANYWHERE = (
    Reading("anywhere in the beam, after all contacts (25 ms)", LATE, "peak_plastic_strain"),
    Reading("anywhere in the beam, after 1 ms", EARLY, "peak_plastic_strain"),
)
"""The whole beam, with the zone under the sphere."""


def _judge_elastic(data: Data) -> Iterator[Judgement]:
    for reading in AWAY:
        yield attempt(reading.words, _judge_elastic_case, data, reading)


def _judge_elastic_case(case: str, data: Data, reading: Reading) -> Judgement:
    curve = reading.curve(data)
    low = curve.velocity <= ELASTIC_UP_TO
    if curve.velocity[low].max(initial=0.0) < ELASTIC_UP_TO:
        raise UnknownError(f"the study {reading.study} has no run at {ELASTIC_UP_TO:g} m/s")
    worst = int(curve.high[low].argmax())
    largest = curve.number(worst, f"largest PEEQ up to {ELASTIC_UP_TO:g} m/s", "1")
    stands = largest.high == 0.0
    why = (
        "No fibre there yields on any grid."
        if stands
        else f"Some fibre there yields at {curve.velocity[worst]:g} m/s."
    )
    return Judgement(case, (largest,), verdict(stands, reading=not reading.literal), why)


ELASTIC_TO_5 = Statement(
    "elastic_to_5",
    text="Up to 5 m/s there is no plastic strain away from the impact.",
    test="PEEQ + U = 0 farther than one beam depth from mid-span, at every velocity up to 5 m/s.",
    judge=_judge_elastic,
    studies=(LATE, EARLY),
)


def _judge_limit(
    case: str, data: Data, reading: Reading, velocity: float, *, below: bool
) -> Judgement:
    """Judge the strain below the limit, or above it; unknown where U encloses the limit."""
    found = finest_grid(runs_of(data, reading.study), reading.response, velocity=velocity)
    name = f"PEEQ at {velocity:g} m/s"
    strain = Number(name, found.value, "1", found.uncertainty, percent=True)
    require_known(strain)
    under, over = strain.high < LIMIT, strain.low > LIMIT
    if not (under or over):
        why = f"The limit lies within the uncertainty, {100 * strain.uncertainty:.2g} %."
        return Judgement(case, (strain,), Verdict.UNKNOWN, why)
    side = "below" if under else "above"
    sure = "by more than its uncertainty" if strain.uncertainty else "on every grid"
    why = f"It lies {side} the limit {sure}."
    return Judgement(case, (strain,), verdict(under is below, reading=not reading.literal), why)


def _judge_below_limit(data: Data) -> Iterator[Judgement]:
    for reading in (*AWAY, *ANYWHERE):
        yield attempt(reading.words, _judge_limit, data, reading, BELOW_LIMIT_AT, below=True)


BELOW_LIMIT_AT_10 = Statement(
    "below_limit_at_10",
    text="At 10 m/s the plastic strain along the beam stays below 0.2 %.",
    test=(
        "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %, and cannot be judged in "
        "between."
    ),
    judge=_judge_below_limit,
    studies=(LATE, EARLY),
)


def _judge_above_limit(data: Data) -> Iterator[Judgement]:
    for velocity in ABOVE_LIMIT_AT:
        for reading in AWAY:
            case = f"{velocity:g} m/s, {reading.words}"
            yield attempt(case, _judge_limit, data, reading, velocity, below=False)


ABOVE_LIMIT_AT_15 = Statement(
    "above_limit_at_15",
    text="At 15 and 20 m/s the plastic strain is above 0.2 % away from the impact, too.",
    test=(
        "PEEQ − U > 0.2 % farther than one beam depth from mid-span; it does not hold where "
        "PEEQ + U < 0.2 %, and cannot be judged in between."
    ),
    judge=_judge_above_limit,
    studies=(LATE, EARLY),
)


def _judge_first_yield(data: Data) -> Iterator[Judgement]:
    for reading in (*AWAY, *ANYWHERE):
        yield attempt(reading.words, _judge_first_yield_case, data, reading)


def _judge_first_yield_case(case: str, data: Data, reading: Reading) -> Judgement:
    below, above = _first_yield(reading.curve(data))
    if isnan(below) or isnan(above):
        raise UnknownError(f"the velocities of {reading.study} do not enclose the first yield")
    found = Number("velocity at first yield", 0.5 * (below + above), "m s-1", 0.5 * (above - below))
    low, high = FIRST_YIELD_BETWEEN
    stands = low <= below and above <= high
    why = f"No plastic strain at {below:g} m/s, some at {above:g} m/s."
    return Judgement(case, (found,), verdict(stands, reading=not reading.literal), why)


def _first_yield(curve: Curve) -> tuple[float, float]:
    """Return the last velocity without plastic strain before the first with it, and that one.

    NaN for a velocity that the curve does not have.
    """
    plastic = curve.value > 0
    first = int(np.argmax(plastic)) if plastic.any() else plastic.size
    below = float(curve.velocity[first - 1]) if first else float("nan")
    return below, float(curve.velocity[first]) if plastic.any() else float("nan")


PLASTICITY_BEGINS = Statement(
    "plasticity_begins",
    text="Plasticity outside the contact begins between 5 and 10 m/s.",
    test=(
        "The largest velocity with PEEQ = 0 and the smallest with PEEQ > 0 both lie from 5 to 10 "
        "m/s. The uncertainty is half of the gap between the two, on the finest grid."
    ),
    judge=_judge_first_yield,
    studies=(LATE, EARLY),
)
