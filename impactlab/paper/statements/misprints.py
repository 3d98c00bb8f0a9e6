"""Misprints and open points on the scheme, the beam and the contacts."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from impactlab.model.impact import paper_impact
from impactlab.paper.statements.convergence import READINGS_OF_P
from impactlab.paper.statements.evidence import runs_of, select_response
from impactlab.paper.statements.statement import (
    Data,
    Judgement,
    Number,
    Statement,
    Verdict,
    attempt,
    verdict,
)
from impactlab.verification.solutions import bending, explicit_beam, quadrature

NODES, STEPS = 601, 20
"""Grid and steps of the explicit integration that tests the printed time step."""
SHARE_OF_LIMIT = 0.99
"""Share of a limit that is tested: the printed rule says “less than”."""
BOUNDED_GROWTH = 1e3
"""Growth since the first step beyond which the solution counts as diverging."""
PRINTED_MASS = 10.929
"""Mass of the beam, kg."""
MASS_TOLERANCE, SECTION_TOLERANCE = 0.005, 0.05
"""Relative differences."""
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
        "dt ≤ (dx²/2) √(ρA/(EI)q), (EI)q the stiffness that the integration rule gives; with "
        "the contact ω² ≤ 16 (EI)q/(ρA dx⁴) + k (1/(ρA dx) + 1/m)"
    ),
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
    holds="10.148 kg; a beam of 840 mm would have 10.929 kg",
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
    text="Two integration points represent the section (“P = 2 suffices”).",
    test=(
        "The rule's elastic stiffness B Σ E w z² and its full plastic moment B Σ σ_y w |z| agree "
        "within 5 % with E B H³/12 and σ_y B H²/4."
    ),
    judge=_judge_few_points,
    holds="2 Lobatto points are 3 times too stiff; with 3 the section yields all at once",
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
    holds="an impact has several sub-impacts: state which contact is meant (here the first)",
)
