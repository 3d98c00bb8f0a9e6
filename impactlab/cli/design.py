"""From a study file to the design of its runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS, StudyFile
from impactlab.cli.settling import settled


def design(
    study: StudyFile,
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/design.nc.")] = None,
) -> None:
    """Sample a study into its runs.

    A discretisation that is `auto` is found first, as by `impactlab recommend`.
    """
    from impactlab.study.declaration import read_study
    from impactlab.study.netcdf import write_netcdf
    from impactlab.study.sampling import design as sampled

    path = output or RESULTS / study.stem / "design.nc"
    write_netcdf(sampled(settled(read_study(study), path.with_name("resolution.nc"))), path)
