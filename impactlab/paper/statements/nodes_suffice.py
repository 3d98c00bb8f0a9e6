"""N = 601 is the least number of nodes for convergence."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from impactlab.analysis.convergence.axis import judge as converged
from impactlab.analysis.verdicts import TOLERANCE
from impactlab.paper.statements import responses_groups as groups
from impactlab.paper.statements.claim import Data, Judgement, Number, Verdict, attempt
from impactlab.paper.statements.evidence import answers, number, runs_of

SAYS = "N = 601 nodes are the least for convergence."
TEST = (
    "Of each response f: |f(601) − f∞| + U ≤ 1 % of f∞, and no smaller N of the study "
    "does as well. f∞: Richardson's value, or where there is none that of the most nodes; U: its "
    "uncertainty (grid convergence index). PEEQ apart."
)
STUDY = "fig06_nodes"
PRINTED = 601
_NEVER = np.inf


def judge(data: Data) -> Iterable[Judgement]:
    """For each velocity, the responses of force and motion, and those of plastic strain."""
    for velocity, group, names in groups.cases(data, STUDY):
        case = f"{velocity:g} m/s, {group}"
        yield attempt(case, lambda c=case, v=velocity, n=names: _judged(c, data, v, n))  # type: ignore[misc]


def _judged(case: str, data: Data, velocity: float, names: tuple[str, ...]) -> Judgement:
    found = [_error(data, velocity, name) for name in names]
    errors, needed = [error for error, _ in found], [least for _, least in found]
    worst = names[int(np.argmax([error.high for error in errors]))].replace("_", " ")
    least = max(needed)
    numbers = (*errors, Number("least nodes for all of them", least, "1"))
    if max(error.high for error in errors) > TOLERANCE:
        why = f"With {PRINTED} nodes the {worst} is not known to {100 * TOLERANCE:g} %."
        return Judgement(case, numbers, Verdict.FAILS, why)
    if least == PRINTED:
        return Judgement(case, numbers, Verdict.HOLDS, "Fewer nodes of the study fall short.")
    why = f"Read as “{PRINTED} are enough”: {least:g} already are."
    return Judgement(case, numbers, Verdict.READING, why)


def _error(data: Data, velocity: float, name: str) -> tuple[Number, float]:
    """The relative error at N = 601, and the least nodes from which on it stays in tolerance."""
    runs = runs_of(data, STUDY)
    where = {"velocity": velocity, "points": int(runs["points"].max())}
    values = answers(runs, name, **where).sortby("nodes", ascending=False)
    finest = number(runs, name, **where)
    limit = converged(values.values.astype(float), 1.0 / (values["nodes"].values - 1.0))
    reference = limit.extrapolated if np.isfinite(limit.extrapolated) else finest.value
    share = finest.uncertainty / abs(reference) if reference else 0.0 if not finest.high else np.inf
    error = abs(values - reference) / (abs(reference) or 1.0)
    within = (error + share <= TOLERANCE).values
    count = int(np.argmin(within)) if not within.all() else within.size
    least = float(values["nodes"].values[count - 1]) if count else _NEVER
    at = float(error.sel(nodes=PRINTED))
    return Number(f"error of the {name.replace('_', ' ')}", at, "1", share), least
