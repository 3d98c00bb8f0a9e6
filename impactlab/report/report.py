"""The report of a study: one HTML file that needs nothing else."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.analysis.sensitivity.table import indices
from impactlab.figures import labels
from impactlab.figures.access import count
from impactlab.report import cautions, convergence, inputs, notes, outcome, provenance, sections
from impactlab.report.page import write_page
from impactlab.report.pictures import Picture, pictures
from impactlab.report.section import Section


def write_report(runs: xr.Dataset, analysis: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a study from its stored datasets and figures.

    runs: runs.nc; analysis: analysis.nc; figures_folder: what draw_all wrote. The report
    of a sample links indices.csv, which lies beside its analysis. Raises FileNotFoundError when a
    figure is missing, OSError when `path` cannot be written.
    """
    first, then = sections.sections(runs, analysis, "indices.csv" if indices(analysis) else "")
    ordered = _numbered(pictures(figures_folder), [*first, *then])
    rest = [name for name in ordered if not _placed(name, [*first, *then])]
    if rest or not ordered:
        then = [*then, sections.figures(rest)]
    write_page(
        "report.html.j2",
        path,
        pictures=ordered,
        files=os.path.relpath(figures_folder, path.parent),
        first=first,
        then=then,
        **_about(runs, analysis),
    )


def _placed(name: str, found: Sequence[Section]) -> bool:
    return any(name in section.figures for section in found)


def _numbered(drawn: list[Picture], found: Sequence[Section]) -> dict[str, Picture]:
    """The figures by name, numbered as they stand on the page: those of no section come last."""
    order = {name: at for at, name in enumerate(n for section in found for n in section.figures)}
    ranked = sorted(drawn, key=lambda picture: order.get(picture.name, len(order)))
    return {picture.name: replace(picture, number=at) for at, picture in enumerate(ranked, 1)}


def _about(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, Any]:
    """What the study is, what to be wary of, and where it comes from."""
    name = str(runs.attrs.get("study", "study"))
    return {
        "study": name,
        "title": str(runs.attrs.get("title") or name),
        "description": str(runs.attrs.get("description", "")),
        "method": labels.method(str(runs.attrs.get("method", "grid"))),
        "runs": count(runs),
        "varied": inputs.varied_parameters(runs),
        "failed": outcome.outcome(runs).failed,
        "cautions": cautions.cautions(runs, analysis),
        "notes": notes.notes(runs),
        "convergence": convergence.judged(runs, analysis),
        "provenance": provenance.provenance(runs),
        "commands": provenance.commands(runs),
        "study_text": str(runs.attrs.get("study_text", "")),
    }
