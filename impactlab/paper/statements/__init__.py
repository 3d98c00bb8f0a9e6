"""The paper's statements and misprints, and observations of ours, tested on solved studies.

A new statement is a function marked `@statement` in the module of its subject.
"""

from __future__ import annotations

from impactlab.paper.statements import (
    convergence,
    misprints,
    omissions,
    plastic_strain,
    three_d,
    velocity,
)
from impactlab.paper.statements.statement import Data, Judgement, Statement

STATEMENTS: list[Statement] = [
    entry
    for module in (three_d, convergence, velocity, plastic_strain, omissions, misprints)
    for entry in vars(module).values()
    if isinstance(entry, Statement)
]
"""In the order of their definitions."""


def judge_all(data: Data) -> list[tuple[Statement, list[Judgement]]]:
    """Return all statements with their judgements on the runs of the studies that there are."""
    return [
        (entry, list(entry.judge({name: data[name] for name in entry.studies if name in data})))
        for entry in STATEMENTS
    ]
