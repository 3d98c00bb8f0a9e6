"""From solved runs to their analysis."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RunsFile


def analyse(
    runs: RunsFile,
    resolution: Annotated[
        Path | None, typer.Option(help="What `recommend` found: numerical uncertainty.")
    ] = None,
    refinement: Annotated[
        Path | None, typer.Option(help="What `refine` solved: the same of Sobol indices, measured.")
    ] = None,
    output: Annotated[Path | None, typer.Option(help="Default: beside the runs.")] = None,
) -> None:
    """Convergence and sensitivity from solved runs.

    Of a sample also, beside the output: every index with its interval (indices.csv, indices.nc),
    and surrogate.nc for `impactlab predict`.
    """
    from impactlab.study.steps import analyse_runs

    analyse_runs(runs, output or runs.with_name("analysis.nc"), resolution, refinement)
