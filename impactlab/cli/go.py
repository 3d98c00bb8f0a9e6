"""A study from its file to its report, in one command."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from impactlab.cli.options import StudyFile, results_file


def go(
    study: StudyFile,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
    force: Annotated[
        bool, typer.Option("--force", help="Also what takes a month of one core, or all memory.")
    ] = False,
) -> None:
    """Do everything for one study: run, analyse, figures and report.

    Of a verification: verify, figures and report. Runs that are solved are not solved again.
    """
    from impactlab.cli import results, solve
    from impactlab.cli.verify import verify
    from impactlab.study import REFINEMENT, RESOLUTION
    from impactlab.study.schema.files import describe, read_any

    name = read_any(study).name
    traits = describe(study)["traits"]
    runs, analysis, findings, resolution, refinement = (
        results_file(name, file)
        for file in ("runs.nc", "analysis.nc", "findings.nc", RESOLUTION, f"{REFINEMENT}.nc")
    )
    failed = False
    if "checks" in traits:
        stored = [findings]
        try:
            verify(study)
        except typer.Exit:  # the report comes first, the verdict last
            failed = True
    else:
        solve.run(study, workers=workers, force=force)
        if "sobol" in traits:
            solve.refine(runs, workers=workers)
        known = "auto" in traits and "sample" in traits
        results.analyse(
            runs, resolution if known else None, refinement if "sobol" in traits else None
        )
        stored = [runs, analysis]
    results.figures(stored)
    results.report(stored)
    if failed:
        raise typer.Exit(code=1)
