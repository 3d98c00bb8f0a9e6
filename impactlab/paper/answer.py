"""The answer to the paper: results/paper with its figures, claims.html, claims.csv, numbers.csv."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from impactlab.paper import page as claims
from impactlab.paper.figures import Stored, draw_paper
from impactlab.paper.statements.catalogue import judge_all
from impactlab.report import provenance
from impactlab.report.page import write_page
from impactlab.report.pictures import pictures
from impactlab.study.netcdf import read_netcdf
from impactlab.variables import provenance as made_now

log = logging.getLogger(__name__)


def read_solved(folders: Sequence[Path]) -> Stored:
    """runs.nc and analysis.nc of each folder, by the folder's name; what is not there is named.

    Raises OSError naming a file that cannot be read.
    """
    found: dict[str, tuple[xr.Dataset, xr.Dataset]] = {}
    for folder in folders:
        paths = folder / "runs.nc", folder / "analysis.nc"
        if all(path.exists() for path in paths):
            found[folder.name] = (read_netcdf(paths[0]), read_netcdf(paths[1]))
        else:
            log.warning("%s holds no runs.nc with an analysis.nc: it is left out", folder)
    return found


def write_paper(stored: Stored, folder: Path) -> None:
    """Draw the figures, judge the statements, and write both.

    Raises OSError where the folder cannot be written.
    """
    draw_paper(stored, folder / "figures")
    statements, misprints = judge_all({name: runs for name, (runs, _) in stored.items()})
    claims.write_csv([*statements, *misprints], folder / "claims.csv")
    claims.write_numbers([*statements, *misprints], folder / "numbers.csv")
    write_page(
        "claims.html.j2",
        folder / "claims.html",
        overviews=[claims.overview("Statements", statements), claims.misprints(misprints)],
        statements=[claims.section(claim) for claim in statements],
        misprints=[claims.section(claim) for claim in misprints],
        pictures=pictures(folder / "figures"),
        tally=claims.tally(statements),
        solved=claims.solved({name: runs for name, (runs, _) in stored.items()}),
        provenance=provenance.provenance(xr.Dataset(attrs=made_now()), "page"),
    )
