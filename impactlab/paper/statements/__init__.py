"""The paper's statements and misprints, and observations of ours, tested on solved studies.

A new statement is a function marked `@statement` in the module of its subject.
"""

from impactlab.paper.statements import (
    misprints,
    omissions,
    plastic_strain,
    resolution,
    three_d,
    velocity,
)
from impactlab.paper.statements.statement import Assessment, Data, Statement

STATEMENTS: list[Statement] = [
    entry
    for module in (three_d, resolution, velocity, plastic_strain, omissions, misprints)
    for entry in vars(module).values()
    if isinstance(entry, Statement)
]
"""In the order of their definitions."""


def judge_all(data: Data) -> list[tuple[Statement, list[Assessment]]]:
    """Return all statements with their assessments on the runs of the studies that there are."""
    return [
        (entry, list(entry.judge({name: data[name] for name in entry.studies if name in data})))
        for entry in STATEMENTS
    ]
