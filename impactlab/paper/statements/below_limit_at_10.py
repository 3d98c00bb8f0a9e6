"""Plastic strain below 0.2 % along the beam at 10 m/s."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements import plasticity
from impactlab.paper.statements.claim import Data, Judgement, attempt, known
from impactlab.paper.statements.limits import against
from impactlab.paper.statements.plasticity import LIMIT, Reading

SAYS = "At 10 m/s the plastic strain along the beam stays below 0.2 %."
TEST = "PEEQ + U < 0.2 %; it does not hold where PEEQ − U > 0.2 %, and is open between."
VELOCITY = 10.0


def judge(data: Data) -> Iterable[Judgement]:
    """Away from the impact and anywhere, after all contacts and after the first."""
    for reading in (*plasticity.AWAY, *plasticity.ANYWHERE):
        yield attempt(reading.words, lambda r=reading: _judged(r, data))  # type: ignore[misc]


def _judged(reading: Reading, data: Data) -> Judgement:
    found = plasticity.strain(data, reading, VELOCITY)
    known(found)
    verdict, why = against(found, LIMIT, below=True, as_read=not reading.literal)
    return Judgement(reading.words, (found,), verdict, why)
