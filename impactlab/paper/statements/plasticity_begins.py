"""Plasticity outside the contact begins between 5 and 10 m/s."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan

from impactlab.paper.statements import plasticity
from impactlab.paper.statements.claim import Data, Judgement, Number, UnknownError, attempt, holds
from impactlab.paper.statements.plasticity import Reading

SAYS = "Plasticity outside the contact begins between 5 and 10 m/s."
TEST = (
    "The largest velocity with PEEQ = 0 and the smallest with PEEQ > 0 both lie from 5 to 10 m/s. "
    "The uncertainty is half of the gap between the two, on the finest grid."
)
BETWEEN = (5.0, 10.0)


def judge(data: Data) -> Iterable[Judgement]:
    """Away from the impact and anywhere, after all contacts and after the first."""
    for reading in (*plasticity.AWAY, *plasticity.ANYWHERE):
        yield attempt(reading.words, lambda r=reading: _judged(r, data))  # type: ignore[misc]


def _judged(reading: Reading, data: Data) -> Judgement:
    below, above = plasticity.beginning(plasticity.strains(data, reading))
    if isnan(below) or isnan(above):
        raise UnknownError(f"the velocities of {reading.study} do not enclose the beginning")
    found = Number("velocity at first yield", 0.5 * (below + above), "m s-1", 0.5 * (above - below))
    low, high = BETWEEN
    stands = low <= below and above <= high
    why = f"None at {below:g} m/s, some at {above:g} m/s."
    return Judgement(reading.words, (found,), holds(stands, as_read=not reading.literal), why)
