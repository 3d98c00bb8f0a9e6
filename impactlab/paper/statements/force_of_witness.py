"""The peak force lies within 2.4 % of that of a 3-D finite-element model."""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements.agreement import Agreement
from impactlab.paper.statements.claim import Data, Judgement
from impactlab.paper.statements.curves import BEAM
from impactlab.paper.statements.witness import VELOCITY

SAYS = "The peak force lies within 2.4 % of that of a 3-D finite-element model."
TEST = (
    "|F(beam)/F(3-D) − 1| ± U ≤ 2.4 %; F: largest force; U: the numerical uncertainties of both. "
    "3-D: this project's solid model in the place of the paper's. The paper states it at 0.99 m/s "
    "of its own beam; other velocities, and the Timoshenko beam, are readings."
)
_AGREEMENT = Agreement(
    "peak_force", limit=0.024, below="smaller", above="larger", stated=(VELOCITY, BEAM)
)


def judge(data: Data) -> Iterable[Judgement]:
    """A judgement for each velocity and each beam model."""
    return _AGREEMENT.judged(data)
