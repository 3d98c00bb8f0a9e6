"""The beam's mass."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.model.paper import paper_impact
from impactlab.paper.statements.claim import Data, Judgement, Number, holds

SAYS = "The beam has a mass of 10.929 kg (Table 2)."
TEST = "ρ B H L of the paper's own density and measures agrees with the printed mass within 0.5 %."
HOLDS = "10.148 kg; 840 mm of the beam would have 10.929 kg"
PRINTED = 10.929
_WITHIN = 0.005


def judge(data: Data) -> Iterable[Judgement]:
    """One judgement, of closed forms."""
    beam = paper_impact().beam
    per_length = beam.material.density * beam.width * beam.depth
    mass = per_length * beam.span
    numbers = (
        Number("ρ B H L", mass, "kg"),
        Number("span of the printed mass", PRINTED / per_length, "m"),
    )
    off = PRINTED / mass - 1.0
    stands = abs(off) <= _WITHIN
    why = f"Printed and computed mass differ by {100 * off:.1f} % of the latter."
    return [Judgement("density 7800 kg/m³, 27.8 × 60 × 780 mm", numbers, holds(stands), why)]
