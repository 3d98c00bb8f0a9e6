"""The effect of a finer discretisation on sensitivity indices."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import RunsFile


def refine(
    runs: RunsFile,
    output: Annotated[
        Path | None, typer.Option(help="Default: refinement.nc, beside the runs.")
    ] = None,
    base_samples: Annotated[
        int | None,
        typer.Option(min=16, help="How many are solved again. Default: N/8, from 16 to 64."),
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Solve the first runs of a Sobol sample on finer grids.

    `impactlab analyse --refinement` estimates the numerical error of the indices from them; more
    base samples narrow the estimate.
    """
    stop_at_once()
    from impactlab.study import steps
    from impactlab.study.engine import Engine

    path = output or runs.with_name("refinement.nc")
    steps.refine(runs, path, Engine("threads", workers), base_samples)
