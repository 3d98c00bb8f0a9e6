"""What two and three Lobatto points make of the beam."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, holds
from impactlab.paper.statements.points_suffice import READINGS
from impactlab.verification.solutions import bending, quadrature

SAYS = "Two integration points give the section (“P = 2 suffices”)."
TEST = (
    "The rule's elastic stiffness B Σ E w z² and its full plastic moment B Σ σ_y w |z| agree "
    "within 5 % with E B H³/12 and σ_y B H²/4."
)
HOLDS = "2 Lobatto points are 3 times too stiff; with 3 the section yields all at once"
_WITHIN = 0.05
_FAR = 1e3
"""Curvature over that at first yield: every fibre but one on the axis has yielded."""


def judge(data: Data) -> Iterable[Judgement]:
    """For each reading of P, by the rule alone: no beam is solved."""
    beam = paper_impact().beam
    yielding = bending.yield_curvature(beam)
    curvature = np.array([1e-6, _FAR]) * yielding
    exact = np.array([beam.bending_stiffness * curvature[0], bending.plastic_moment(beam)])
    for reading, rule, points in READINGS:
        moments = bending.rule_moment(beam, curvature, *quadrature.rule(rule, points))
        stiffness, plastic = (moments / exact).tolist()
        numbers = (
            Number("stiffness over the exact one", stiffness, "1"),
            Number("full plastic moment over the exact one", plastic, "1"),
        )
        off = [abs(ratio - 1.0) > _WITHIN for ratio in (stiffness, plastic)]
        wrong = [n.name.split(" over")[0] for n, bad in zip(numbers, off, strict=True) if bad]
        why = f"Off by more than 5 %: {', '.join(wrong)}." if wrong else "Both agree."
        literal = reading == READINGS[0][0]
        yield Judgement(reading, numbers, holds(not wrong, as_read=not literal), why)
