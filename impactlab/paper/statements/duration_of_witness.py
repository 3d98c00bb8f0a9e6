"""The contact duration against the velocity agrees with a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements.agreement import Agreement
from impactlab.paper.statements.claim import Data, Judgement

SAYS = "The contact duration against the velocity agrees with a 3-D finite-element model."
TEST = (
    "|t(beam)/t(3-D) − 1| ± U ≤ 5 %, t: duration of the first contact, U: the numerical "
    "uncertainties of both. The paper gives no number: 5 % is ours, about what its figure shows: "
    "a case that holds does so under a reading."
)


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each velocity and each beam model."""
    return Agreement("contact_duration", limit=0.05, below="shorter", above="longer").judged(data)
