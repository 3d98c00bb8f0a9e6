"""The paper's statements and misprints, tested on solved studies.

A new statement is a function marked `@statement` in the module of its subject and a line here.
"""

from __future__ import annotations

from impactlab.paper.statements import convergence, misprints, three_d, velocity
from impactlab.paper.statements.statement import Data, Judgement, Statement

STATEMENTS: tuple[Statement, ...] = (
    convergence.nodes_suffice,
    convergence.points_suffice,
    velocity.duration_falls,
    velocity.above_spring_mass,
    velocity.dent_grows,
    velocity.elastic_to_5,
    velocity.below_limit_at_10,
    velocity.above_limit_at_15,
    velocity.plasticity_begins,
    three_d.force_of_witness,
    three_d.displacement_of_witness,
    three_d.duration_of_witness,
    three_d.plastic_zone_of_witness,
    misprints.time_step,
    misprints.unloading_radius,
    misprints.elastic_phase,
    misprints.fully_plastic,
    misprints.beam_mass,
    misprints.few_points,
    misprints.restitution,
    misprints.sub_impacts,
)


def judge_all(data: Data) -> list[tuple[Statement, list[Judgement]]]:
    """Return all statements with their judgements on the runs of the studies that there are."""
    return [
        (each, list(each.judge({name: data[name] for name in each.studies if name in data})))
        for each in STATEMENTS
    ]
