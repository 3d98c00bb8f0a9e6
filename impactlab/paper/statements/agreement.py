"""A response of the beam models beside the 3-D model's, held against a limit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial

from impactlab.paper.statements import witness
from impactlab.paper.statements.claim import Data, Judgement, Verdict, attempt, holds


@dataclass(frozen=True)
class Agreement:
    """|beam/3-D − 1| ± U ≤ limit, U: the numerical uncertainties of both.

    below, above: how a smaller and a larger answer is told, such as "shorter" and "longer".
    stated: (velocity in m/s, beam model) that the paper speaks of; all others are readings.
    """

    response: str
    limit: float
    below: str
    above: str
    stated: tuple[float, str] | None = None

    def judged(self, data: Data) -> Iterable[Judgement]:
        """A judgement for each velocity and each beam model."""
        for velocity in witness.velocities(data):
            for model, words in witness.BEAMS.items():
                case = f"{velocity:g} m/s, {words}"
                yield attempt(case, partial(self._one, case, data, velocity, model))

    def _one(self, case: str, data: Data, velocity: float, model: str) -> Judgement:
        ours = witness.beam(data, self.response, velocity, model)
        theirs = witness.solid(data, self.response, velocity)
        gap = witness.difference(ours, theirs, "difference, in parts of the 3-D model's")
        numbers = (ours, theirs, gap)
        least, most = abs(gap.value) - gap.uncertainty, abs(gap.value) + gap.uncertainty
        if least <= self.limit < most:
            why = f"{self.limit:.1%} lies within the uncertainty of the two models together."
            return Judgement(case, numbers, Verdict.UNKNOWN, why)
        why = f"The beam's is {abs(gap.value):.1%} {self.below if gap.value < 0 else self.above}."
        as_read = (velocity, model) != self.stated
        return Judgement(case, numbers, holds(most <= self.limit, as_read=as_read), why)
