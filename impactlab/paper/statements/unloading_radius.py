"""The radius of the unloading curve, Eq. 17."""

from __future__ import annotations

import math
from collections.abc import Iterable

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, UnknownError, attempt, holds
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.stronge import StrongeImpact, stronge_impact

SAYS = "The unloading curve has the radius R_e of Eq. 17 (and of Table 1)."
TEST = (
    "With δ_r = δ_m − δ_y R_e/R* (Eq. 15), the unloading force (4/3) E* √R_e (δ_m − δ_r)^1.5 at "
    "the deepest indentation equals the loading force F_m (Eq. 16) within 10⁻⁹, for δ_m/δ_y = 3, "
    "30, 300."
)
HOLDS = "R_e = √(3 F_m/(4 E*)) (R*/δ_y)^(3/4), that is R_e/R* = √(F_m/F_y)"
DEPTHS = (3.0, 30.0, 300.0)
_WITHIN = 1e-9


def judge(data: Data) -> Iterable[Judgement]:
    """As printed, as derived, and with the power under the root, as the print may mean."""
    yield attempt("as printed", _printed)
    yield _judged("as derived from Eqs. 15 and 16", exponent=0.75)
    yield _judged("the root drawn over the whole product", exponent=0.375)


def _printed() -> Judgement:
    raise UnknownError("The root in Eq. 17 is garbled: what it covers cannot be read.")


def _judged(case: str, exponent: float) -> Judgement:
    """R_e = sqrt(3 F_m/(4 E*)) (R*/delta_y)^exponent; a length for any exponent."""
    law = stronge_impact(paper_impact())
    worst = max((_jump(law, x * law.yield_indentation, exponent) for x in DEPTHS), key=abs)
    found = Number("largest jump of the force over F_m", worst, "1")
    stands = abs(worst) <= _WITHIN
    why = (
        "Loading and unloading meet, which leaves this form alone."
        if stands
        else "The force would jump where unloading begins."
    )
    return Judgement(case, (found,), holds(stands), why)


def _jump(law: StrongeImpact, deepest: float, exponent: float) -> float:
    """(unloading force - F_m)/F_m, with radius R_e, at the deepest indentation (m)."""
    peak = law.loading_force(deepest)
    ratio = law.effective_radius / law.yield_indentation
    radius = math.sqrt(0.75 * peak / law.effective_modulus) * ratio**exponent
    recovered = law.yield_indentation * radius / law.effective_radius
    force = hertz.stiffness(law.effective_modulus, radius) * recovered**1.5
    return float(force / peak - 1.0)
