"""P = 2 is the least number of integration points for convergence, under each reading of P."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.analysis.verdicts import TOLERANCE
from impactlab.paper.statements import responses_groups as groups
from impactlab.paper.statements.claim import Data, Judgement, Number, attempt, holds
from impactlab.paper.statements.evidence import answers, runs_of

SAYS = "P = 2 integration points over the depth are the least for convergence."
TEST = (
    "Of each response f: |f(P) − f(most)| + U ≤ 1 % of f(most), at 601 nodes. U: what "
    "f changes between the most points and the next fewer. What “P” counts is open: each reading "
    "has a row."
)
STUDY = "fig06_points"
READINGS = (
    ("two Lobatto points over the depth (as printed)", "lobatto", 2),
    ("two Lobatto points over half the depth, the axis one of them (3 in all)", "lobatto", 3),
    ("two Lobatto points in each half of the depth (4 in all)", "lobatto", 4),
    ("two Gauss points over the depth", "legendre", 2),
)
"""What P = 2 may mean: words, rule, points over the whole depth; the first is the literal one."""


def judge(data: Data) -> Iterable[Judgement]:
    """For each reading and velocity, force and motion, and plastic strain."""
    for reading, rule, points in READINGS:
        for velocity, group, names in groups.cases(data, STUDY):
            case = f"{reading}; {velocity:g} m/s, {group}"
            where = {"velocity": velocity, "rule": rule}
            yield attempt(
                case,
                lambda c=case, w=where, p=points, n=names: _judged(c, data, w, p, n),  # type: ignore[misc]
            )


def _judged(
    case: str, data: Data, where: dict[str, object], points: int, names: tuple[str, ...]
) -> Judgement:
    errors = tuple(_error(data, where, points, name) for name in names)
    worst = max(errors, key=lambda error: error.high)
    stands = worst.high <= TOLERANCE
    literal = case.startswith(READINGS[0][0])
    why = f"The {worst.name} is {100 * worst.value:,.1f} %."
    if stands:
        why = "Every error is within 1 %."
    return Judgement(case, errors, holds(stands, as_read=not literal), why)


def _error(data: Data, where: dict[str, object], points: int, name: str) -> Number:
    """The relative error of a response with so many points; infinite where it should be zero."""
    values = answers(runs_of(data, STUDY), name, **where).sortby("points", ascending=False)
    most, next_fewer = (float(values.isel(points=at)) for at in (0, 1))
    given = float(values.sel(points=points))
    scale = abs(most) or (np.nan if given or next_fewer else 1.0)
    gaps = (abs(value - most) / scale for value in (given, next_fewer))
    error, spread = (np.inf if np.isnan(gap) else float(gap) for gap in gaps)
    return Number(f"error of the {name.replace('_', ' ')}", error, "1", spread)
