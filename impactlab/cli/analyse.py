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
    from impactlab.analysis.analyse import analyse as analysed
    from impactlab.analysis.sensitivity.indices import sensitivity_variables, write_csv
    from impactlab.analysis.surrogate import packed
    from impactlab.figures.files import replaced
    from impactlab.study.netcdf import read_netcdf, write_netcdf

    solved, path = read_netcdf(runs), output or runs.with_name("analysis.nc")
    others = [read_netcdf(each) if each else None for each in (resolution, refinement)]
    found = analysed(solved, *others)
    write_netcdf(found, path)
    for name in ("indices.csv", "indices.nc", "surrogate.nc"):  # perhaps of another study
        path.with_name(name).unlink(missing_ok=True)
    if indices := sensitivity_variables(found):
        with replaced(path.with_name("indices.csv")) as temporary:
            write_csv(found, temporary)
        write_netcdf(indices, path.with_name("indices.nc"))
    if surrogates := packed(solved, found):
        write_netcdf(surrogates, path.with_name("surrogate.nc"))
