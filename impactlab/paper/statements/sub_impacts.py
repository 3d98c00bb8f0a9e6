"""One impact, one contact?"""

from __future__ import annotations

from collections.abc import Iterable

from impactlab.paper.statements.claim import Data, Judgement, Number, attempt, holds
from impactlab.paper.statements.evidence import answers, runs_of

SAYS = "“The contact time”, as if there were one contact."
TEST = "The runs of figure 5 have one contact each."
HOLDS = "an impact holds several sub-impacts: say which contact is meant (here: the first)"
STUDY = "fig05"


def judge(data: Data) -> Iterable[Judgement]:
    """One judgement."""
    case = "Stronge contact, 0.99 m/s"
    return [attempt(case, lambda: _judged(case, data))]


def _judged(case: str, data: Data) -> Judgement:
    runs = runs_of(data, STUDY)
    where = {"contact": "stronge"} if "contact" in runs.dims else {}
    count = float(answers(runs, "number_of_contacts", **where).max())
    found = Number(f"contacts within {float(runs['duration']) * 1e3:g} ms", count, "1")
    why = "The beam comes back and strikes the sphere again." if count > 1 else "There is one."
    return Judgement(case, (found,), holds(count == 1.0), why)
