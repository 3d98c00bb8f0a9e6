"""Misprints and open points in the paper's contact law, tested by closed forms."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from impactlab.model.impact import paper_impact
from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    attempt,
    verdict,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.stronge import (
    CONSTRAINT,
    HARDNESS,
    U_PLASTIC,
    StrongeImpact,
    stronge_impact,
)

DEPTHS = (3.0, 30.0, 300.0)
"""Deepest over yield indentation at which the unloading curve is tested."""
EQUAL = 1e-9
"""Relative difference within which two forces agree."""


def _judge_unloading_radius(data: Data) -> Iterator[Judgement]:
    yield attempt("as printed", _judge_garbled_radius)
    yield _judge_radius("as derived from Eqs. 15 and 16", exponent=0.75)
    yield _judge_radius("the root drawn over the whole product", exponent=0.375)


def _judge_garbled_radius(case: str) -> Judgement:
    raise UnknownError("The root in Eq. 17 is garbled: what it covers cannot be read.")


def _judge_radius(case: str, exponent: float) -> Judgement:
    """Judge R_e = sqrt(3 F_m/(4 E*)) (R*/delta_y)^exponent; a length for any exponent."""
    law = stronge_impact(paper_impact())
    jumps = (_jump(law, x * law.yield_indentation, exponent) for x in DEPTHS)
    worst = max(jumps, key=abs)
    number = Number("largest jump of the force over F_m", worst, "1")
    stands = abs(worst) <= EQUAL
    why = (
        "Loading and unloading forces agree, with this form alone."
        if stands
        else "The force would jump where unloading begins."
    )
    return Judgement(case, (number,), verdict(stands), why)


def _jump(law: StrongeImpact, deepest: float, exponent: float) -> float:
    """Return (unloading force - F_m)/F_m, with radius R_e, at the deepest indentation (m)."""
    peak = law.loading_force(deepest)
    ratio = law.effective_radius / law.yield_indentation
    radius = math.sqrt(0.75 * peak / law.effective_modulus) * ratio**exponent
    recovered = law.yield_indentation * radius / law.effective_radius
    force = hertz.stiffness(law.effective_modulus, radius) * recovered**1.5
    return float(force / peak - 1.0)


UNLOADING_RADIUS = Statement(
    "unloading_radius",
    text="The unloading curve has the radius R_e of Eq. 17 (and of Table 1).",
    test=(
        "With δ_r = δ_m − δ_y R_e/R* (Eq. 15), the unloading force (4/3) E* √R_e (δ_m − δ_r)^1.5 "
        "at the deepest indentation equals the loading force F_m (Eq. 16) within 10⁻⁹, for "
        "δ_m/δ_y = 3, 30, 300."
    ),
    judge=_judge_unloading_radius,
    holds="R_e = √(3 F_m/(4 E*)) (R*/δ_y)^(3/4), that is R_e/R* = √(F_m/F_y)",
)


def _judge_elastic_phase(data: Data) -> Iterator[Judgement]:
    law = stronge_impact(paper_impact())
    stiffness = hertz.stiffness(law.effective_modulus, law.effective_radius)
    deepest = law.yield_indentation
    for case, forces in (
        ("as printed", [stiffness * deepest**1.5] * 2),
        ("with δ in the place of δ_y", [stiffness * delta**1.5 for delta in (0.0, deepest)]),
    ):
        numbers = (
            Number("force at δ = 0", forces[0], "N"),
            Number("force at δ = δ_y", forces[1], "N"),
        )
        stands = forces[0] == 0.0 < forces[1]
        why = (
            "It grows from zero."
            if stands
            else "The printed expression is a constant, not a force law."
        )
        yield Judgement(case, numbers, verdict(stands), why)


ELASTIC_PHASE = Statement(
    "elastic_phase",
    text="Table 1, elastic phase: F = (4/3) E* √R* δ_y^(3/2).",
    test="F = 0 where the contact begins (δ = 0), and the force grows with the indentation.",
    judge=_judge_elastic_phase,
    holds="F = (4/3) E* √R* δ^(3/2)",
)


def _judge_fully_plastic(data: Data) -> Iterator[Judgement]:
    for case, x in (("the often quoted 84 δ_y", 84.0), ("by continuity", 0.5 * (U_PLASTIC + 1.0))):
        u = 2.0 * x - 1.0
        jump = HARDNESS / CONSTRAINT / (1.0 + math.log(u) / (3.0 * CONSTRAINT)) - 1.0
        numbers = (Number("δ/δ_y", x, "1"), Number("jump of the force", jump, "1", percent=True))
        stands = abs(jump) <= EQUAL
        why = "The two forces agree." if stands else "The force jumps there."
        yield Judgement(case, numbers, verdict(stands), why)


FULLY_PLASTIC = Statement(
    "fully_plastic",
    text="The fully plastic phase begins at an indentation that the paper does not give.",
    test=(
        "The elastic-plastic force F_y u (1 + ln(u)/3.3) and the fully plastic one 2.8 F_y u/1.1 "
        "agree there within 10⁻⁹; u = 2 δ/δ_y − 1."
    ),
    judge=_judge_fully_plastic,
    holds="continuity: ln(u) = 3 (2.8 − 1.1), δ/δ_y = 82.511",
)


def _judge_restitution(data: Data) -> Iterator[Judgement]:
    law = stronge_impact(paper_impact())
    ratios = np.geomspace(1.0, 300.0, 4001)[1:]
    depths = ratios * law.yield_indentation
    restitution = np.sqrt(
        [law.released_work(float(d)) / law.loading_work(float(d)) for d in depths]
    )
    above = restitution > 1.0
    numbers = [Number("largest restitution", float(restitution.max()), "1")]
    why = "It is at most 1."
    if above.any():
        end = float(ratios[above].max())
        numbers.append(Number("δ_m/δ_y up to which it is above 1", end, "1", end * 0.0015))
        why = "The law creates energy in shallow contacts; the energy audit of the runs counts it."
    yield Judgement("Stronge's law", tuple(numbers), verdict(not above.any()), why)


RESTITUTION = Statement(
    "restitution",
    text="Unloading with force continuity (Eqs. 15 to 17) returns part of the energy.",
    test=(
        "The coefficient of restitution of the contact alone is at most 1 for every "
        "1 < δ_m/δ_y < 300."
    ),
    judge=_judge_restitution,
    holds="the coefficient is above 1 for small δ_m/δ_y: the law itself creates energy there",
)
