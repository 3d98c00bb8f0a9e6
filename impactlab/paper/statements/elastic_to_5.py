"""No plastic strain away from the impact up to 5 m/s."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements import plasticity
from impactlab.paper.statements.claim import Data, Judgement, Number, UnknownError, attempt, holds
from impactlab.paper.statements.plasticity import Reading

SAYS = "Up to 5 m/s there is no plastic strain away from the impact."
TEST = "PEEQ + U = 0 farther than one beam depth from mid-span, at every velocity up to 5 m/s."
UP_TO = 5.0


def judge(data: Data) -> Iterable[Judgement]:
    """After all contacts, and after the first."""
    for reading in plasticity.AWAY:
        yield attempt(reading.words, lambda r=reading: _judged(r, data))  # type: ignore[misc]


def _judged(reading: Reading, data: Data) -> Judgement:
    curve = plasticity.strains(data, reading)
    low = curve.velocity <= UP_TO
    if curve.velocity[low].max(initial=0.0) < UP_TO:
        raise UnknownError(f"the study {reading.study} has no run at {UP_TO:g} m/s")
    worst = int(curve.high[low].argmax())
    found = Number(
        f"largest PEEQ up to {UP_TO:g} m/s",
        float(curve.value[worst]),
        "1",
        float(curve.uncertainty[worst]),
    )
    stands = found.high == 0.0
    why = (
        "No fibre there yields on any grid."
        if stands
        else f"There is some at {curve.velocity[worst]:g} m/s."
    )
    return Judgement(reading.words, (found,), holds(stands, as_read=not reading.literal), why)
