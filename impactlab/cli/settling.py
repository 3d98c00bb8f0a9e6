"""A discretisation that is `auto` is found before a study is sampled."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import TRIALS

if TYPE_CHECKING:
    import xarray as xr

    from impactlab.study.engine import Engine
    from impactlab.study.schema.study import FunctionStudy, Study


def settled(study: Study | FunctionStudy, evidence: Path, engine: Engine) -> Study | FunctionStudy:
    """The study, its discretisation found by trials where it is auto; a file keeps these.

    engine: solves the trials.
    """
    from impactlab.study.schema.study import FunctionStudy

    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    from impactlab.report.console import print_recommendation
    from impactlab.study.adaptive.recommendation import apply_recommendation, recommend
    from impactlab.study.netcdf import write_netcdf

    found = _kept(study, evidence)
    if found is None:
        stop_at_once()
        found = recommend(study, evidence.with_name(TRIALS), engine)
        write_netcdf(found, evidence)
    print_recommendation(found)
    return apply_recommendation(study, found)


def settled_before(study: Study | FunctionStudy, evidence: Path) -> Study | FunctionStudy | None:
    """The study as `settled` gives it; None where the trials have still to be made."""
    from impactlab.study.schema.study import FunctionStudy

    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    from impactlab.study.adaptive.recommendation import apply_recommendation

    found = _kept(study, evidence)
    return None if found is None else apply_recommendation(study, found)


def _kept(study: Study, evidence: Path) -> xr.Dataset | None:
    """What was found before for this very study."""
    from impactlab.study.adaptive.recommendation import fits
    from impactlab.study.netcdf import read_netcdf

    found = read_netcdf(evidence) if evidence.exists() else None
    return None if found is None or not fits(found, study) else found
