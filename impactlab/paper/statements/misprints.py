"""Misprints and open points of the paper: what is printed, what holds instead, and the check."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.convergence import READINGS_OF_P
from impactlab.paper.statements.evidence import runs_of, select_response
from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    UnknownError,
    Verdict,
    attempt,
    verdict,
)
from impactlab.verification.solutions import bending, explicit_beam, hertz, quadrature
from impactlab.verification.solutions.stronge import (
    CONSTRAINT,
    HARDNESS,
    U_PLASTIC,
    StrongeImpact,
    stronge_impact,
)

NODES, STEPS = 601, 20
"""Of the explicit integration that tests the printed time step."""
SHARE_OF_LIMIT = 0.99
"""The printed rule says “less than”."""
BOUNDED_GROWTH = 1e3
"""Growth since the first step beyond which the solution counts as diverging."""
DEPTHS = (3.0, 30.0, 300.0)
"""Deepest over yield indentation at which the unloading curve is tested."""
EQUAL = 1e-9
"""Relative difference within which two forces agree."""
PRINTED_MASS = 10.929
"""Of the beam, kg."""
MASS_TOLERANCE, SECTION_TOLERANCE = 0.005, 0.05
FULLY_YIELDED = 1e3
"""Curvature over that at first yield: every fibre but one on the axis has yielded."""
CONTACTS_STUDY = "fig05"


def _judge_time_step(data: Data) -> Iterator[Judgement]:
    beam = paper_impact().beam
    bending_limit = "the limit of bending instead, dt < (dx²/2) √(ρA/EI)"
    yield _judge_step("as printed", SHARE_OF_LIMIT * explicit_beam.bar_wave_step(beam, NODES))
    yield _judge_step(bending_limit, SHARE_OF_LIMIT * explicit_beam.bending_step(beam, NODES))


def _judge_step(case: str, dt: float) -> Judgement:
    beam = paper_impact().beam
    frequency = explicit_beam.highest_frequency(beam, NODES)
    largest = explicit_beam.march(beam, NODES, dt, STEPS)
    grown = float(largest[-1] / largest[0])
    numbers = (
        Number("ω dt", frequency * dt, "1"),
        Number("growth of the highest mode per step", explicit_beam.growth(frequency, dt), "1"),
        Number(f"deflection after {STEPS} steps over that after 1", grown, "1"),
    )
    if frequency * dt <= 2.0 and grown < BOUNDED_GROWTH:
        return Judgement(case, numbers, Verdict.HOLDS, "The solution stays bounded.")
    why = (
        "It is the limit of a bar wave; bending is stiffer on a fine grid, and the solution "
        "diverges."
    )
    return Judgement(case, numbers, Verdict.FAILS, why)


TIME_STEP = Statement(
    "time_step",
    text="The scheme is stable for dt < dx/√(E/ρ).",
    test=(
        "ω dt ≤ 2 with ω = (4/dx²) √(EI/ρA), the highest frequency of the grid; and an explicit "
        "integration of the elastic beam alone with that step, after an impulse at mid-span, stays "
        "bounded. N = 601."
    ),
    judge=_judge_time_step,
    holds=(
        "dt ≤ (dx²/2) √(ρA/(EI)q), (EI)q the stiffness that the integration rule really has; with "
        "the contact ω² ≤ 16 (EI)q/(ρA dx⁴) + k (1/(ρA dx) + 1/m)"
    ),
)


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
        "Loading and unloading meet, which they do with this form alone."
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


def _judge_beam_mass(data: Data) -> Iterator[Judgement]:
    beam = paper_impact().beam
    per_length = beam.material.density * beam.width * beam.depth
    mass = per_length * beam.span
    numbers = (
        Number("ρ B H L", mass, "kg"),
        Number("span of the printed mass", PRINTED_MASS / per_length, "m"),
    )
    off = PRINTED_MASS / mass - 1.0
    why = f"Printed and computed mass differ by {100 * off:.1f} % of the latter."
    stands = abs(off) <= MASS_TOLERANCE
    yield Judgement("density 7800 kg/m³, 27.8 × 60 × 780 mm", numbers, verdict(stands), why)


BEAM_MASS = Statement(
    "beam_mass",
    text="The beam has a mass of 10.929 kg (Table 2).",
    test="ρ B H L, of the paper's density and sizes, agrees with the printed mass within 0.5 %.",
    judge=_judge_beam_mass,
    holds="10.148 kg; 840 mm of the beam would have 10.929 kg",
)


def _judge_few_points(data: Data) -> Iterator[Judgement]:
    beam = paper_impact().beam
    curvature = np.array([1e-6, FULLY_YIELDED]) * bending.yield_curvature(beam)
    exact = np.array([beam.bending_stiffness * curvature[0], bending.plastic_moment(beam)])
    for reading, rule, points in READINGS_OF_P:
        moments = bending.rule_moment(beam, curvature, *quadrature.rule(rule, points))
        ratios = dict(zip(("stiffness", "full plastic moment"), moments / exact, strict=True))
        numbers = tuple(
            Number(f"{name} over the exact one", float(ratio), "1")
            for name, ratio in ratios.items()
        )
        wrong = [name for name, ratio in ratios.items() if abs(ratio - 1.0) > SECTION_TOLERANCE]
        why = f"Off by more than 5 %: {', '.join(wrong)}." if wrong else "Both agree."
        literal = reading == READINGS_OF_P[0][0]
        yield Judgement(reading, numbers, verdict(not wrong, reading=not literal), why)


FEW_POINTS = Statement(
    "few_points",
    text="Two integration points give the section (“P = 2 suffices”).",
    test=(
        "The rule's elastic stiffness B Σ E w z² and its full plastic moment B Σ σ_y w |z| agree "
        "within 5 % with E B H³/12 and σ_y B H²/4."
    ),
    judge=_judge_few_points,
    holds="2 Lobatto points are 3 times too stiff; with 3 the section yields all at once",
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
    text="Unloading with force continuity (Eqs. 15 to 17) returns a part of the energy.",
    test=(
        "The coefficient of restitution of the contact alone is at most 1 for every "
        "1 < δ_m/δ_y < 300."
    ),
    judge=_judge_restitution,
    holds="above 1 over a range of small δ_m/δ_y: the law itself creates energy there",
)


def _judge_sub_impacts(data: Data) -> Iterator[Judgement]:
    yield attempt("Stronge contact, 0.99 m/s", _judge_contacts, data)


def _judge_contacts(case: str, data: Data) -> Judgement:
    runs = runs_of(data, CONTACTS_STUDY)
    where = {"contact": "stronge"} if "contact" in runs.dims else {}
    count = float(select_response(runs, "number_of_contacts", **where).max())
    number = Number(f"contacts within {float(runs['duration']) * 1e3:g} ms", count, "1")
    why = "There is one."
    if count > 1:
        why = "The beam comes back and strikes the sphere again."
    return Judgement(case, (number,), verdict(count == 1.0), why)


SUB_IMPACTS = Statement(
    "sub_impacts",
    text="“The contact time”, as if there were one contact.",
    test="The runs of figure 5 have one contact each.",
    judge=_judge_sub_impacts,
    studies=(CONTACTS_STUDY,),
    holds="an impact holds several sub-impacts: say which contact is meant (here: the first)",
)
