"""From a study file to the design of its runs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import StudyFile, results_file
from impactlab.cli.settling import settled


def design(
    study: StudyFile,
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/design.nc.")] = None,
) -> None:
    """Sample a study into its runs.

    A discretisation that is `auto` is found first, as by `impactlab recommend`.
    """
    from impactlab.study.engine import Engine
    from impactlab.study.netcdf import write_netcdf
    from impactlab.study.sampling.design import design as sampled
    from impactlab.study.schema.files import read_study

    declared = read_study(study)
    path = output or results_file(declared.name, "design.nc")
    engine = Engine(workers=os.cpu_count() or 1)
    write_netcdf(sampled(settled(declared, path.with_name("resolution.nc"), engine)), path)
