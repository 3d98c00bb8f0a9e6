"""The elastic phase of Table 1."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, holds
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.stronge import stronge_impact

SAYS = "Table 1, elastic phase: F = (4/3) E* √R* δ_y^(3/2)."
TEST = "F = 0 where the contact begins (δ = 0), and the force grows with the indentation."
HOLDS = "F = (4/3) E* √R* δ^(3/2)"


def judge(data: Data) -> Iterable[Judgement]:
    """As printed, and with δ in the place of δ_y."""
    law = stronge_impact(paper_impact())
    stiffness = hertz.stiffness(law.effective_modulus, law.effective_radius)
    deepest = law.yield_indentation
    for case, forces in (
        ("as printed", [stiffness * deepest**1.5] * 2),
        ("with δ in the place of δ_y", [stiffness * delta**1.5 for delta in (0.0, deepest)]),
    ):
        numbers = tuple(
            Number(name, force, "N")
            for name, force in zip(("force at δ = 0", "force at δ = δ_y"), forces, strict=True)
        )
        stands = forces[0] == 0.0 < forces[1]
        why = "It grows from zero." if stands else "Printed is a constant, not a force law."
        yield Judgement(case, numbers, holds(stands), why)
