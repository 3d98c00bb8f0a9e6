"""The plastic zone at 0.99 m/s reaches 1.52 mm from the centre of the impact."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.analysis.claims import witness
from impactlab.analysis.claims.claim import Data, Judgement, Number, Verdict, attempt, holds

SAYS = "At 0.99 m/s the plastic zone reaches 1.52 mm from the centre (3-D finite elements)."
TEST = (
    "Half of the length of beam in which any element of the 3-D model has a PEEQ above 1e-5 at the "
    "end, at any depth; U: its numerical uncertainty, and at least the size of an element, in "
    "which the length is counted. 1.52 mm lies within it. Which strain the paper's zone ends at is "
    "not said: this is a reading."
)
PRINTED = 1.52e-3


def judge(data: Data) -> Iterable[Judgement]:
    """One judgement."""
    case = f"{witness.VELOCITY:g} m/s, PEEQ above 1e-5"
    return [attempt(case, lambda: _judged(case, data))]


def _judged(case: str, data: Data) -> Judgement:
    size = witness.smallest_element(data)
    length = witness.solid(data, "plastic_zone_length", witness.VELOCITY, least=2.0 * size)
    reach = Number("extent from the centre", 0.5 * length.value, "m", 0.5 * length.uncertainty)
    within = reach.low <= PRINTED <= reach.high
    if within and reach.uncertainty > 0.5 * PRINTED:
        why = "The elements are too large to tell."
        return Judgement(case, (reach,), Verdict.UNKNOWN, why)
    why = f"The printed extent lies {'within' if within else 'outside of'} the uncertainty."
    return Judgement(case, (reach,), holds(within, as_read=True), why)
