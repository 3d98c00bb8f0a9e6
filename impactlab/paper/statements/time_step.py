"""The paper's time step."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, Verdict, holds
from impactlab.verification.solutions import explicit_beam

SAYS = "The scheme is stable for dt < dx/√(E/ρ)."
TEST = (
    "ω dt ≤ 2 with ω = (4/dx²) √(EI/ρA), the highest frequency of the grid; and a plain march of "
    "the elastic beam alone at that step, from a knock at mid-span, stays bounded. N = 601."
)
HOLDS = (
    "dt ≤ (dx²/2) √(ρA/(EI)q), (EI)q the stiffness that the integration rule really has; with the "
    "contact ω² ≤ 16 (EI)q/(ρA dx⁴) + k (1/(ρA dx) + 1/m)"
)
_NODES, _STEPS = 601, 20
_SHARE = 0.99
"""Of each limit: the rule says “less than”."""
_FACTOR = 1e3
"""Growth from the first step on beyond which a march is not bounded."""


def judge(data: Data) -> Iterable[Judgement]:
    """The step as printed, and the one of bending beside it."""
    beam = paper_impact().beam
    for case, limit in (
        ("as printed", explicit_beam.bar_wave_step(beam, _NODES)),
        (
            "the limit of bending instead, dt < (dx²/2) √(ρA/EI)",
            explicit_beam.bending_step(beam, _NODES),
        ),
    ):
        yield _judged(case, _SHARE * limit)


def _judged(case: str, dt: float) -> Judgement:
    beam = paper_impact().beam
    frequency = explicit_beam.highest_frequency(beam, _NODES)
    largest = explicit_beam.march(beam, _NODES, dt, _STEPS)
    grown = float(largest[-1] / largest[0])
    numbers = (
        Number("ω dt", frequency * dt, "1"),
        Number("growth of the highest mode in a step", explicit_beam.growth(frequency, dt), "1"),
        Number(f"deflection after {_STEPS} steps over that after 1", grown, "1"),
    )
    stable = frequency * dt <= 2.0 and grown < _FACTOR
    if stable:
        return Judgement(case, numbers, holds(True), "The march stays bounded.")
    why = (
        "It is the limit of a bar wave; bending is stiffer on a fine grid, and the march diverges."
    )
    return Judgement(case, numbers, Verdict.FAILS, why)
