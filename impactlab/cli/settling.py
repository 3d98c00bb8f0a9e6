"""A discretisation that is `auto` is found before a study is sampled."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from impactlab.cli.interrupt import stop_at_once

if TYPE_CHECKING:
    from impactlab.study.declaration import FunctionStudy, Study


def settled(study: Study | FunctionStudy, evidence: Path) -> Study | FunctionStudy:
    """The study, its discretisation found by trials where it is auto; a file keeps these."""
    from impactlab.study.declaration import FunctionStudy

    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    from impactlab.report.recommendation import print_recommendation
    from impactlab.steering.recommending import recommend
    from impactlab.steering.resolving import fits, resolved
    from impactlab.study.engine import Engine
    from impactlab.study.netcdf import read_netcdf, write_netcdf

    found = read_netcdf(evidence) if evidence.exists() else None
    if found is None or not fits(found, study):
        stop_at_once()
        engine = Engine("threads", os.cpu_count() or 1)
        found = recommend(study, evidence.with_name("trials"), engine)
        write_netcdf(found, evidence)
    print_recommendation(found)
    return resolved(study, found)
