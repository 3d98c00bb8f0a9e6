"""The kinds of study results: which files hold them, and how they are drawn, told and listed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count
from impactlab.figures.draw import draw_all, draw_findings
from impactlab.report.report import write_report
from impactlab.report.verification import tally, write_verification
from impactlab.study.netcdf import read_netcdf
from impactlab.verification.stored import unpacked


@dataclass(frozen=True)
class Kind:
    """One kind of results.

    files: stored beside the report; the first holds the study's title. drawn(*datasets, folder)
    writes the figures; told(*datasets, figures_folder, path) the report. listed(dataset of the
    first file): how much there is and what failed ("" for nothing), for the index.
    """

    files: tuple[str, ...]
    drawn: Callable[..., object]
    told: Callable[..., object]
    listed: Callable[[xr.Dataset], tuple[str, str]]

    def draw(self, datasets: Sequence[xr.Dataset], folder: Path) -> None:
        """Draw the figures into a folder."""
        self.drawn(*datasets, folder)

    def write(self, datasets: Sequence[xr.Dataset], figures: Path, path: Path) -> None:
        """Write the report, with the figures of a folder."""
        self.told(*datasets, figures, path)


def _runs(runs: xr.Dataset) -> tuple[str, str]:
    method = labels.method(str(runs.attrs.get("method", "grid")))
    failed = int(access.failed(runs).sum())
    return f"{count(runs)} runs ({method})", f"{failed} failed" if failed else ""


def _findings(findings: xr.Dataset) -> tuple[str, str]:
    found = tally(unpacked(findings))
    pairs = (found.checks, found.comparisons), (found.bad_checks, found.failed)
    size, failed = (
        [labels.counted(checks, "check"), labels.counted(comparisons, "comparison")]
        for checks, comparisons in pairs
    )
    return ", ".join(size), "" if found.passed else f"{labels.listing(failed)} failed"


RUNS = Kind(("runs.nc", "analysis.nc"), draw_all, write_report, _runs)
FINDINGS = Kind(("findings.nc",), draw_findings, write_verification, _findings)


def read_stored(paths: Sequence[Path]) -> tuple[Kind, list[xr.Dataset]]:
    """The datasets of a study's results, and their kind.

    Raises OSError naming a file that cannot be read, ValueError where files are missing or too
    many.
    """
    datasets = [read_netcdf(path) for path in paths]
    kind = FINDINGS if "tolerance" in datasets[0] else RUNS
    if len(paths) != len(kind.files):
        asked = " and ".join(kind.files)
        raise ValueError(f"{paths[0]}: expected {asked}, but got {len(paths)} files")
    return kind, datasets


def kind_in(folder: Path) -> Kind | None:
    """The kind of the results in a folder; None where there are none."""
    return next((kind for kind in (RUNS, FINDINGS) if (folder / kind.files[0]).exists()), None)
