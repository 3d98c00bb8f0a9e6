"""The contact duration falls with the velocity."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.paper.statements.claim import Data, Judgement, Number, Verdict, attempt
from impactlab.paper.statements.curves import Curve, against_velocity, laws, named

SAYS = "The contact duration falls as the impact velocity rises."
TEST = (
    "t(v₂) + U₂ < t(v₁) − U₁ for every two neighbouring velocities v₁ < v₂; t: duration of the "
    "first contact. Holds under a reading where that is so over more than half of the velocities, "
    "from the lowest on."
)
STUDY = "fig08"


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each contact law of the study."""
    for law in laws(data, STUDY):
        yield attempt(named(law), lambda law=law: _judged(law, data))  # type: ignore[misc]


def _judged(law: str, data: Data) -> Judgement:
    curve = against_velocity(data, STUDY, "contact_duration", contact=law)
    falls = curve.high[1:] < curve.low[:-1]
    count = falls.size if falls.all() else int(np.argmin(falls))
    numbers = _numbers(curve, count)
    first, last = curve.velocity[0], curve.velocity[-1]
    case = f"{named(law)}, {first:g} to {last:g} m/s"
    if count == falls.size:
        why = f"It falls at every one of the {count} steps."
        return Judgement(case, numbers, Verdict.HOLDS, why)
    here, there = curve.velocity[count], curve.velocity[count + 1]
    rises = curve.low[count + 1] > curve.high[count]
    change = "rises" if rises else "does not fall by more than its uncertainty"
    why = f"It falls up to {here:g} m/s and {change} from there to {there:g} m/s"
    why += ": the sphere no longer lifts off between two pushes." if _merges(curve, count) else "."
    verdict = Verdict.READING if 2 * count > falls.size else Verdict.FAILS
    return Judgement(case, numbers, verdict, why)


def _numbers(curve: Curve, count: int) -> tuple[Number, ...]:
    """The duration at the lowest velocity, where it stops falling, and at the highest."""
    places = dict.fromkeys((0, count, curve.velocity.size - 1))
    return tuple(
        Number(
            f"contact duration at {curve.velocity[at]:g} m/s",
            float(curve.value[at]),
            "s",
            float(curve.uncertainty[at]),
        )
        for at in places
    )


def _merges(curve: Curve, count: int) -> bool:
    """Whether the duration jumps by a quarter: a second push has become part of the first."""
    return bool(curve.value[count + 1] > 1.25 * curve.value[count])
