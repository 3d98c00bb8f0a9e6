"""From a design to solved runs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import RESULTS
from impactlab.cli.settling import settled


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
        float, typer.Option(min=0.001, hidden=True, help="Of a task, about.")
    ] = 1.0,
) -> None:
    """Solve the runs of a study that have not been solved yet.

    Finished batches are kept in results/NAME/shards: an interrupted study goes on from there.
    """
    stop_at_once()
    from functools import partial

    from impactlab.study.declaration import read_study
    from impactlab.study.engine import Engine
    from impactlab.study.execution import execute
    from impactlab.study.netcdf import read_netcdf, write_netcdf
    from impactlab.study.sampling import design as sampled
    from impactlab.study.slurm import read_profile

    if design_file.suffix == ".nc":
        samples = read_netcdf(design_file)
    else:
        evidence = (output or RESULTS / design_file.stem / "runs.nc").with_name("resolution.nc")
        samples = sampled(settled(read_study(design_file), evidence))
    path = output or RESULTS / samples.attrs["study"] / "runs.nc"
    profile = read_profile(cluster) if cluster else None
    engine = Engine(
        "processes" if processes else "threads", workers, scheduler, profile, batch_seconds
    )
    solve = partial(execute, shards_folder=path.parent / "shards", engine=engine)
    if "until_interval" in samples.attrs:
        from impactlab.analysis.analyse import analyse as analysed
        from impactlab.steering.extending import extended

        write_netcdf(extended(samples, solve, analysed), path)
    else:
        write_netcdf(solve(samples), path)
