"""The checks of a verification."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import new_file, results_file


def verify(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="A study file of checks, or its findings.nc.")
    ],
    output: Annotated[Path | None, new_file(help="Default: results/NAME/findings.nc.")] = None,
    exit_zero: Annotated[
        bool, typer.Option("--exit-zero", help="Exit with code 0 even if checks fail.")
    ] = False,
) -> None:
    """Compare the solver with independent solutions.

    The exit code is 1 if a check fails; the findings are written either way. Given a findings.nc,
    the command prints its verdict again.
    """
    from impactlab.files import read_netcdf, write_netcdf
    from impactlab.report.console import print_outcomes
    from impactlab.study.schema.files import read_verification
    from impactlab.study.steps import check, failure
    from impactlab.verification.stored import unpacked

    if study.suffix == ".nc":
        findings = read_netcdf(study, "findings")
    else:
        declared = read_verification(study)
        path = output or results_file(declared.name, "findings.nc")
        findings = check(declared)
        write_netcdf(findings, path, "findings")
    outcomes = unpacked(findings)
    print_outcomes(outcomes)
    if said := failure(outcomes):
        logging.getLogger("impactlab").error("%s", said)
        raise typer.Exit(code=0 if exit_zero else 1)
