"""The checks of a verification."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import results_file


def verify(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="A study file of checks, or its findings.nc.")
    ],
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/findings.nc.")] = None,
    exit_zero: Annotated[
        bool,
        typer.Option("--exit-zero", help="End with exit code 0 although a check fails."),
    ] = False,
) -> None:
    """Hold the solver against independent solutions.

    Exit code 1 where a check fails; what was found is written all the same. Of a findings.nc the
    verdict is told again.
    """
    from impactlab.report.console import print_outcomes
    from impactlab.study.checking import check, failure
    from impactlab.study.netcdf import read_netcdf, write_netcdf
    from impactlab.study.schema.files import read_verification
    from impactlab.verification.stored import unpacked

    if study.suffix == ".nc":
        findings = read_netcdf(study)
    else:
        declared = read_verification(study)
        path = output or results_file(declared.name, "findings.nc")
        findings = check(declared)
        write_netcdf(findings, path)
    outcomes = unpacked(findings)
    print_outcomes(outcomes)
    if said := failure(outcomes):
        logging.getLogger("impactlab").error("%s", said)
        raise typer.Exit(code=0 if exit_zero else 1)
