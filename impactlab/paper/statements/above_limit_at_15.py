"""Plastic strain above 0.2 % away from the impact at 15 and 20 m/s."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements import plasticity
from impactlab.paper.statements.claim import Data, Judgement, attempt, known
from impactlab.paper.statements.limits import against
from impactlab.paper.statements.plasticity import LIMIT, Reading

SAYS = "At 15 and 20 m/s the plastic strain is above 0.2 % away from the impact, too."
TEST = (
    "PEEQ − U > 0.2 % farther than one beam depth from mid-span; it does not hold where "
    "PEEQ + U < 0.2 %, and is open between."
)
VELOCITIES = (15.0, 20.0)


def judge(data: Data) -> Iterable[Judgement]:
    """At both velocities, after all contacts and after the first."""
    for velocity in VELOCITIES:
        for reading in plasticity.AWAY:
            case = f"{velocity:g} m/s, {reading.words}"
            yield attempt(case, lambda c=case, r=reading, v=velocity: _judged(c, r, v, data))  # type: ignore[misc]


def _judged(case: str, reading: Reading, velocity: float, data: Data) -> Judgement:
    found = plasticity.strain(data, reading, velocity)
    known(found)
    verdict, why = against(found, LIMIT, below=False, as_read=not reading.literal)
    return Judgement(case, (found,), verdict, why)
