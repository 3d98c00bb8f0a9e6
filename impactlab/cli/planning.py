"""What a run will cost is told, and asked for twice where it is much, before anything is made."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from impactlab.study.schema.study import FunctionStudy, Study


def allowed(
    study: Study | FunctionStudy, output: Path, workers: int, *, dry_run: bool, force: bool
) -> bool:
    """Whether to go on: not after a dry run, which prints what the study costs.

    output: where the runs go. What is hardly meant is logged.
    Raises StudyError where the study is wrong or, without `force`, beyond bearing.
    """
    from impactlab.report.console import print_estimate
    from impactlab.study.errors import StudyError
    from impactlab.study.estimate import estimate, exceeded_limits, free_disk, implausible

    study = _found(study, output.with_name("resolution.nc"))
    cost = estimate(study, workers)
    for remark in implausible(study):
        logging.getLogger("impactlab").warning("%s", remark)
    problems = exceeded_limits(cost, output.parent)
    if dry_run:
        print_estimate(cost, workers, free_disk(output.parent), problems)
    elif problems and not force:
        raise StudyError(*problems)
    return not dry_run


def _found(study: Study | FunctionStudy, evidence: Path) -> Study | FunctionStudy:
    """The study, with the discretisation that trials have found for it, where they have."""
    from impactlab.study.adaptive.recommendation import apply_recommendation, fits
    from impactlab.study.netcdf import read_netcdf
    from impactlab.study.schema.study import FunctionStudy

    if isinstance(study, FunctionStudy) or study.auto is None or not evidence.exists():
        return study
    found = read_netcdf(evidence)
    return apply_recommendation(study, found) if fits(found, study) else study
