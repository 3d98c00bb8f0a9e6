"""The peak force lies within 2.4 % of that of a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.analysis.claims import witness
from impactlab.analysis.claims.claim import Data, Judgement, Verdict, attempt, holds
from impactlab.analysis.claims.witness import BEAMS

SAYS = "The peak force lies within 2.4 % of that of a 3-D finite-element model."
TEST = (
    "|F(beam)/F(3-D) − 1| ± U ≤ 2.4 %; F: largest force; U: the numerical uncertainties of both. "
    "3-D: this project's solid model in the place of the paper's. The paper states it at 0.99 m/s "
    "of its own beam; other velocities, and the Timoshenko beam, are readings."
)
LIMIT = 0.024


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each velocity and each beam model."""
    for velocity in witness.velocities(data):
        for model, words in BEAMS.items():
            case = f"{velocity:g} m/s, {words}"
            yield attempt(case, lambda c=case, v=velocity, m=model: _judged(c, data, v, m))  # type: ignore[misc]


def _judged(case: str, data: Data, velocity: float, model: str) -> Judgement:
    ours = witness.beam(data, "peak_force", velocity, model)
    theirs = witness.solid(data, "peak_force", velocity)
    gap = witness.difference(ours, theirs, "difference, in parts of the 3-D model's")
    numbers = (ours, theirs, gap)
    least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
    if least <= LIMIT < most:
        why = f"{LIMIT:.1%} lies within the uncertainty of the two models together."
        return Judgement(case, numbers, Verdict.UNKNOWN, why)
    literal = velocity == witness.VELOCITY and model == next(iter(BEAMS))
    side = "below" if gap.value < 0 else "above"
    why = f"The beam's lies {abs(gap.value):.1%} {side}."
    return Judgement(case, numbers, holds(most <= LIMIT, as_read=not literal), why)
