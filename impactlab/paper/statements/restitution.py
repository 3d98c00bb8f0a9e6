"""Unloading with force continuity, and the energy."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, holds
from impactlab.verification.solutions.stronge import stronge_impact

SAYS = "Unloading with force continuity (Eqs. 15 to 17) returns a part of the energy."
TEST = (
    "The coefficient of restitution of the contact alone is at most 1 for every 1 < δ_m/δ_y < 300."
)
HOLDS = "above 1 over a range of small δ_m/δ_y: the law itself creates energy there"


def judge(data: Data) -> Iterable[Judgement]:
    """By the law's closed forms on a half-space."""
    law = stronge_impact(paper_impact())
    ratios = np.geomspace(1.0, 300.0, 4001)[1:]
    depths = ratios * law.yield_indentation
    restitution = np.sqrt(
        [law.released_work(float(d)) / law.loading_work(float(d)) for d in depths]
    )
    above = restitution > 1.0
    numbers = [Number("largest restitution", float(restitution.max()), "1")]
    why = "It is."
    if above.any():
        end = float(ratios[above].max())
        numbers.append(Number("δ_m/δ_y up to which it is above 1", end, "1", end * 0.0015))
        why = "The law creates energy in shallow contacts; the energy audit of the runs counts it."
    return [Judgement("Stronge's law", tuple(numbers), holds(not above.any()), why)]
