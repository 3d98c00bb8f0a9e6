"""The paper's statements and misprints, tested on solved studies.

A new statement is a `Statement` in the module of its subject and a line in STATEMENTS.
"""

from __future__ import annotations

from impactlab.paper.statements import (
    contact,
    contact_law,
    convergence,
    misprints,
    plasticity,
    three_d,
)
from impactlab.paper.statements.statement import Data, JudgedStatement, Statement

STATEMENTS: tuple[Statement, ...] = (
    convergence.NODES_SUFFICE,
    convergence.POINTS_SUFFICE,
    contact.DURATION_FALLS,
    contact.ABOVE_SPRING_MASS,
    contact.DENT_GROWS,
    plasticity.ELASTIC_TO_5,
    plasticity.BELOW_LIMIT_AT_10,
    plasticity.ABOVE_LIMIT_AT_15,
    plasticity.PLASTICITY_BEGINS,
    three_d.FORCE_OF_WITNESS,
    three_d.DISPLACEMENT_OF_WITNESS,
    three_d.DURATION_OF_WITNESS,
    three_d.PLASTIC_ZONE_OF_WITNESS,
    misprints.TIME_STEP,
    contact_law.UNLOADING_RADIUS,
    contact_law.ELASTIC_PHASE,
    contact_law.FULLY_PLASTIC,
    misprints.BEAM_MASS,
    misprints.FEW_POINTS,
    contact_law.RESTITUTION,
    misprints.SUB_IMPACTS,
)


def judge_all(data: Data) -> list[JudgedStatement]:
    """Return all statements with their judgements on the runs of the studies that there are."""
    return [
        JudgedStatement(
            statement,
            tuple(statement.judge({n: data[n] for n in statement.studies if n in data})),
        )
        for statement in STATEMENTS
    ]
