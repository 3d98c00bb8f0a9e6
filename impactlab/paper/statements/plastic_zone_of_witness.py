"""The plastic zone at 0.99 m/s reaches 1.52 mm from the centre of the impact."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements import witness
from impactlab.paper.statements.claim import Data, Judgement, Number, Verdict, attempt, holds

SAYS = "At 0.99 m/s the plastic zone reaches 1.52 mm from the centre (3-D finite elements)."
TEST = (
    "|r − 1.52 mm| ≤ U; U: numerical uncertainty of r, and at least the size of an element. The "
    "paper does not say at which strain its zone ends, so that there are two readings of r: on the "
    "struck surface, where PEEQ falls to 0.2 % along the beam (means of elements, lines between "
    "them); and at any depth, half of the length of beam in which an element has a PEEQ above 1e-5."
)
PRINTED = 1.52e-3
_READINGS = {
    "on the surface, PEEQ above 0.2 %": ("plastic_zone_radius", 1.0),
    "at any depth, PEEQ above 1e-5": ("plastic_zone_length", 0.5),
}
"""A variable of the runs, and what it is multiplied by."""


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each reading."""
    for words, (variable, factor) in _READINGS.items():
        case = f"{witness.VELOCITY:g} m/s, {words}"
        yield attempt(case, lambda c=case, v=variable, f=factor: _judged(c, data, v, f))  # type: ignore[misc]


def _judged(case: str, data: Data, variable: str, factor: float) -> Judgement:
    least = witness.smallest_element(data) / factor
    found = witness.solid(data, variable, witness.VELOCITY, least)
    reach = Number("extent from the centre", factor * found.value, "m", factor * found.uncertainty)
    within = reach.low <= PRINTED <= reach.high
    if within and reach.uncertainty > 0.5 * PRINTED:
        why = "The elements are too large to tell."
        return Judgement(case, (reach,), Verdict.UNKNOWN, why)
    why = f"The printed extent lies {'within' if within else 'outside of'} the uncertainty."
    return Judgement(case, (reach,), holds(within, as_read=True), why)
