"""The paper's statements and misprints, tested on solved studies.

A new statement is a `Statement` in the module of its subject and a line in STATEMENTS.
"""

from __future__ import annotations

from impactlab.paper.statements import convergence, misprints, three_d, velocity
from impactlab.paper.statements.statement import Data, Judgement, Statement

STATEMENTS: tuple[Statement, ...] = (
    convergence.NODES_SUFFICE,
    convergence.POINTS_SUFFICE,
    velocity.DURATION_FALLS,
    velocity.ABOVE_SPRING_MASS,
    velocity.DENT_GROWS,
    velocity.ELASTIC_TO_5,
    velocity.BELOW_LIMIT_AT_10,
    velocity.ABOVE_LIMIT_AT_15,
    velocity.PLASTICITY_BEGINS,
    three_d.FORCE_OF_WITNESS,
    three_d.DISPLACEMENT_OF_WITNESS,
    three_d.DURATION_OF_WITNESS,
    three_d.PLASTIC_ZONE_OF_WITNESS,
    misprints.TIME_STEP,
    misprints.UNLOADING_RADIUS,
    misprints.ELASTIC_PHASE,
    misprints.FULLY_PLASTIC,
    misprints.BEAM_MASS,
    misprints.FEW_POINTS,
    misprints.RESTITUTION,
    misprints.SUB_IMPACTS,
)


def judge_all(data: Data) -> list[tuple[Statement, list[Judgement]]]:
    """Return all statements with their judgements on the runs of the studies that there are."""
    return [
        (each, list(each.judge({name: data[name] for name in each.studies if name in data})))
        for each in STATEMENTS
    ]
