"""Where the fully plastic phase begins."""

from __future__ import annotations

import math
from collections.abc import Iterable

from impactlab.paper.statements.claim import Data, Judgement, Number, holds
from impactlab.verification.solutions.stronge import CONSTRAINT, HARDNESS, U_PLASTIC

SAYS = "The fully plastic phase begins at an indentation that the paper does not give."
TEST = (
    "The elastic-plastic force F_y u (1 + ln(u)/3.3) and the fully plastic one 2.8 F_y u/1.1 agree "
    "there within 10⁻⁹; u = 2 δ/δ_y − 1."
)
HOLDS = "continuity: ln(u) = 3 (2.8 − 1.1), δ/δ_y = 82.511"
_WITHIN = 1e-9


def judge(data: Data) -> Iterable[Judgement]:
    """The often quoted 84, and the place of continuity."""
    for case, x in (("the often quoted 84 δ_y", 84.0), ("by continuity", 0.5 * (U_PLASTIC + 1.0))):
        u = 2.0 * x - 1.0
        jump = HARDNESS / CONSTRAINT / (1.0 + math.log(u) / (3.0 * CONSTRAINT)) - 1.0
        numbers = (Number("δ/δ_y", x, "1"), Number("jump of the force", jump, "1"))
        stands = abs(jump) <= _WITHIN
        why = "The two forces agree." if stands else "The force jumps there."
        yield Judgement(case, numbers, holds(stands), why)
