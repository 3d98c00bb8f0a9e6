"""The tables of statements and of misprints: a new one is a new file and a line here."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.paper.statements import (
    above_limit_at_15,
    above_spring_mass,
    beam_mass,
    below_limit_at_10,
    dent_grows,
    displacement_of_witness,
    duration_falls,
    duration_of_witness,
    elastic_phase,
    elastic_to_5,
    few_points,
    force_of_witness,
    fully_plastic,
    nodes_suffice,
    plastic_zone_of_witness,
    plasticity_begins,
    points_suffice,
    restitution,
    sub_impacts,
    time_step,
    unloading_radius,
)
from impactlab.paper.statements.claim import ClaimFile, Data, Judgement

_STATEMENTS: tuple[ClaimFile, ...] = (
    nodes_suffice,
    points_suffice,
    duration_falls,
    above_spring_mass,
    dent_grows,
    elastic_to_5,
    below_limit_at_10,
    above_limit_at_15,
    plasticity_begins,
    force_of_witness,
    displacement_of_witness,
    duration_of_witness,
    plastic_zone_of_witness,
)
_MISPRINTS: tuple[ClaimFile, ...] = (
    time_step,
    unloading_radius,
    elastic_phase,
    fully_plastic,
    beam_mass,
    few_points,
    restitution,
    sub_impacts,
)
"""What the paper misprints or leaves open; each has HOLDS, what holds in its place."""


@dataclass(frozen=True)
class Claim:
    """A statement with all its judgements. name: its file's; holds: of a misprint, else ""."""

    name: str
    says: str
    test: str
    holds: str
    judgements: tuple[Judgement, ...]


def judge_all(data: Data) -> tuple[list[Claim], list[Claim]]:
    """All statements, and all misprints, judged on the runs of the studies that there are."""
    statements, misprints = (
        [_judged(file, data) for file in files] for files in (_STATEMENTS, _MISPRINTS)
    )
    return statements, misprints


def _judged(file: ClaimFile, data: Data) -> Claim:
    name = str(vars(file)["__name__"]).rpartition(".")[2]
    instead = str(getattr(file, "HOLDS", ""))
    return Claim(name, file.SAYS, file.TEST, instead, tuple(file.judge(data)))
