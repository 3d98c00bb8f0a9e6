"""The contact duration against the velocity agrees with a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.analysis.claims import witness
from impactlab.analysis.claims.claim import Data, Judgement, Verdict, attempt, holds
from impactlab.analysis.claims.witness import BEAMS

SAYS = "The contact duration against the velocity agrees with a 3-D finite-element model."
TEST = (
    "|t(beam)/t(3-D) − 1| ± U ≤ 5 %, t: duration of the first contact, U: the numerical "
    "uncertainties of both. The paper gives no number: 5 % is ours, about what its figure shows: "
    "a case that holds does so under a reading."
)
LIMIT = 0.05


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each velocity and each beam model."""
    for velocity in witness.velocities(data):
        for model, words in BEAMS.items():
            case = f"{velocity:g} m/s, {words}"
            yield attempt(case, lambda c=case, v=velocity, m=model: _judged(c, data, v, m))  # type: ignore[misc]


def _judged(case: str, data: Data, velocity: float, model: str) -> Judgement:
    ours = witness.beam(data, "contact_duration", velocity, model)
    theirs = witness.solid(data, "contact_duration", velocity)
    gap = witness.difference(ours, theirs, "difference, in parts of the 3-D model's")
    numbers = (ours, theirs, gap)
    least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
    if least <= LIMIT < most:
        why = f"{LIMIT:.0%} lies within the uncertainty of the two models together."
        return Judgement(case, numbers, Verdict.UNKNOWN, why)
    side = "shorter" if gap.value < 0 else "longer"
    why = f"The beam's is {abs(gap.value):.1%} {side}."
    return Judgement(case, numbers, holds(most <= LIMIT, as_read=True), why)
