"""From a study file to the design of its runs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.discretisation import with_discretisation
from impactlab.cli.interrupt import stop_at_once
from impactlab.cli.options import StudyFile, results_file


def design(
    study: StudyFile,
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/design.nc.")] = None,
) -> None:
    """Sample a study into its runs.

    A discretisation that is `auto` is found first, as by `impactlab recommend`.
    """
    from impactlab.study.engine import Engine
    from impactlab.study.netcdf import write_netcdf
    from impactlab.study.sampling.design import design as design_of
    from impactlab.study.schema.files import read_study

    declared = read_study(study)
    path = output or results_file(declared.name, "design.nc")
    stop_at_once()
    engine = Engine(workers=os.cpu_count() or 1)
    write_netcdf(design_of(with_discretisation(declared, path.parent, engine)), path)
