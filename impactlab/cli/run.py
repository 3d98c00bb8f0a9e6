"""From a design to solved runs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.discretisation import affordable, with_discretisation
from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import results_file


def run(
    design_file: Annotated[
        Path, typer.Argument(metavar="STUDY", help="A study file, or its design.nc.")
    ],
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/runs.nc.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads or processes.")] = os.cpu_count()
    or 1,
    processes: Annotated[bool, typer.Option("--processes", help="Processes, not threads.")] = False,
    scheduler: Annotated[str, typer.Option(help="Address of a running dask scheduler.")] = "",
    cluster: Annotated[
        Path | None, typer.Option(help="Slurm jobs as in this file; see profiles/slurm.")
    ] = None,
    batch_seconds: Annotated[
        float, typer.Option(min=0.001, help="Of a task, about; more for hundreds of threads.")
    ] = 1.0,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Tell runs, time, memory and disk, and solve nothing.")
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Also what takes a month of one core, or all memory.")
    ] = False,
) -> None:
    """Solve the runs of a study that have not been solved yet.

    Finished batches are kept in results/NAME/shards: an interrupted study resumes there.
    """
    stop_at_once()
    from impactlab.study import steps
    from impactlab.study.engine import Engine, read_profile
    from impactlab.study.netcdf import read_netcdf
    from impactlab.study.sampling.design import design
    from impactlab.study.sampling.doubling import study_of_design
    from impactlab.study.schema.files import read_study

    stored = read_netcdf(design_file) if design_file.suffix == ".nc" else None
    study = read_study(design_file) if stored is None else study_of_design(stored, design_file)
    path = output or results_file(study.name, "runs.nc")
    price = steps.price(study, path.parent, workers)
    if not affordable(price, workers, dry_run=dry_run, force=force):
        return
    profile = read_profile(cluster) if cluster else None
    engine = Engine(
        "processes" if processes else "threads", workers, scheduler, profile, batch_seconds
    )
    if stored is not None:
        steps.solve(stored, path, engine)
    else:
        study = with_discretisation(study, path.parent, engine)
        steps.solve(design(study), path, engine, file=design_file)
