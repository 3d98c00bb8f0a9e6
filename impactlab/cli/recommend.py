"""The discretisation that a study needs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import StudyFile, chosen, given, results_file


def recommend(
    study: StudyFile,
    tolerance: Annotated[
        str,
        typer.Option(
            help="Numerical uncertainty that is good enough, such as '0.5 %'. Default: the "
            "study's, or 1 %."
        ),
    ] = "",
    responses: Annotated[
        str,
        typer.Option(
            help="Which it is asked of, such as peak_force,impulse. Default: those of the study."
        ),
    ] = "",
    output: Annotated[
        Path | None, typer.Option(help="Default: results/NAME/resolution.nc.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Find the cheapest discretisation that is fine enough.

    The study's corner cases are solved with finer and finer discretisations; the file keeps the
    evidence.
    """
    from impactlab.report.console import print_recommendation
    from impactlab.study import TRIALS
    from impactlab.study.adaptive.recommendation import recommend as recommended
    from impactlab.study.engine import Engine
    from impactlab.study.netcdf import write_netcdf
    from impactlab.study.schema.files import read_impacts
    from impactlab.study.schema.model import Auto

    declared = read_impacts(study)
    path = output or results_file(declared.name, "resolution.nc")
    stop_at_once()
    wishes = declared.auto or Auto()
    if tolerance:
        limit = given("--tolerance", tolerance, "1")
        wishes = wishes.model_copy(update={"tolerance": limit})
        if not 0 < limit < 1:
            raise ValueError(f"--tolerance = {tolerance!r}: must lie between 0 and 100 %")
    if asked := chosen("--responses", responses, declared.responses):
        wishes = wishes.model_copy(update={"responses": asked})
    engine = Engine("threads", workers)
    found = recommended(declared, path.with_name(TRIALS), engine, wishes)
    write_netcdf(found, path)
    print_recommendation(found)
