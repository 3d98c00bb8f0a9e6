"""The report of a study: one HTML file that needs nothing else."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from impactlab import wings
from impactlab.analysis.sensitivity.indices import sensitivity_variables
from impactlab.figures import access, labels
from impactlab.figures.access import count, is_sample
from impactlab.figures.samples import scatters
from impactlab.report import runs as of_runs
from impactlab.report import sensitivity
from impactlab.report.cautions import cautions, notes
from impactlab.report.convergence import convergence
from impactlab.report.indices import numerical_sections
from impactlab.report.page import Section, commands, provenance, write_page
from impactlab.report.pictures import Picture, pictures


def write_report(runs: xr.Dataset, analysis: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a study from its stored datasets and figures.

    runs: runs.nc; analysis: analysis.nc; figures_folder: what draw_all wrote. The report
    of a sample links indices.csv, which lies beside its analysis. Raises FileNotFoundError when a
    figure is missing, OSError when `path` cannot be written.
    """
    first, then = _sections(runs, analysis)
    placed = [name for section in (*first, *then) for name in section.figures]
    ordered = _numbered(pictures(figures_folder), placed)
    rest = [name for name in ordered if name not in placed]
    if rest or not ordered:
        lead = "" if rest else "This study stores no data that a figure could show."
        then = [*then, Section("figures", "Figures", lead, figures=rest)]
    name = str(runs.attrs.get("study", "study"))
    write_page(
        "report.html.j2",
        path,
        title=str(runs.attrs.get("title") or name),
        description=str(runs.attrs.get("description", "")),
        method=labels.method(str(runs.attrs.get("method", "grid"))),
        runs=count(runs),
        varied=of_runs.varied_parameters(runs),
        failed=int(access.failed(runs).sum()),
        cautions=cautions(runs, analysis),
        notes=notes(runs),
        convergence=convergence(runs, analysis),
        pictures=ordered,
        files=os.path.relpath(figures_folder, path.parent),
        first=first,
        then=then,
        provenance=provenance(runs),
        commands=commands(runs),
        study_text=str(runs.attrs.get("study_text", "")),
    )


def _sections(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[list[Section], list[Section]]:
    """Return the sections before the one on convergence, and those after it.

    A grid: inputs, how the runs ended, what a wing adds; results. A sample: inputs, distributions,
    scatters, indices, ranking; failures, numerical uncertainty.
    """
    if not is_sample(runs):
        added = wings.added("sections", runs)
        more = added(runs, analysis) if added else []
        return [
            of_runs.inputs(runs),
            of_runs.outcome(runs, analysis),
            *more,
        ], [of_runs.results(runs)]
    file = "indices.csv" if sensitivity_variables(analysis) else ""
    of_sample = [
        of_runs.inputs(runs),
        of_runs.results(runs, ("response_distributions",)),
        _scatter(runs),
        *sensitivity.sections(runs, analysis, file),
        of_runs.outcome(runs, analysis, ("failure_shares", "failure_map")),
        *numerical_sections(runs, analysis),
    ]
    return of_sample, []


def _scatter(runs: xr.Dataset) -> Section:
    lead = (
        "A line that bends or tilts shows a parameter that matters by itself; points that fan out "
        "around a flat line suggest a parameter that matters together with others."
    )
    names = [figure.name for figure in scatters(runs)]
    return Section("scatter", "Each response against each parameter", lead, figures=names)


def _numbered(drawn: Sequence[Picture], placed: Sequence[str]) -> dict[str, Picture]:
    """Return the figures by name, numbered as they stand on the page: unplaced ones come last."""
    order = {name: at for at, name in enumerate(placed)}
    ranked = sorted(drawn, key=lambda picture: order.get(picture.name, len(order)))
    return {picture.name: replace(picture, number=at) for at, picture in enumerate(ranked, 1)}
