"""The report of a study: one HTML file that needs nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.figures.reading import verdicts
from impactlab.figures.reading.contents import count
from impactlab.report import (
    answers,
    cautions,
    convergence,
    inputs,
    notes,
    outcome,
    provenance,
    sensitivity,
)
from impactlab.report.page import write_page
from impactlab.report.pictures import pictures


def write_report(runs: xr.Dataset, analysis: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a study from its stored datasets and figures.

    runs: runs.nc; analysis: analysis.nc; figures_folder: what draw_all wrote. Raises
    FileNotFoundError when a figure is missing, OSError when `path` cannot be written.
    """
    context = _about(runs) | _results(runs, analysis)
    write_page("report.html.j2", path, pictures=pictures(figures_folder), **context)


def _about(runs: xr.Dataset) -> dict[str, Any]:
    """What the study is, what went into it and where it comes from."""
    name = str(runs.attrs.get("study", "study"))
    return {
        "study": name,
        "title": str(runs.attrs.get("title") or name),
        "description": str(runs.attrs.get("description", "")),
        "method": str(runs.attrs.get("method", "grid")),
        "runs": count(runs),
        "varied": inputs.varied_parameters(runs),
        "fixed": inputs.fixed_parameters(runs),
        "provenance": provenance.provenance(runs),
        "commands": provenance.commands(runs),
        "study_text": str(runs.attrs.get("study_text", "")),
    }


def _results(runs: xr.Dataset, analysis: xr.Dataset) -> dict[str, Any]:
    """What came out, and how far to trust it."""
    return {
        "outcome": outcome.outcome(runs),
        "cautions": cautions.cautions(runs, analysis),
        "notes": notes.notes(runs),
        "ranges": answers.ranges(runs),
        "values": answers.values(runs),
        "convergence": convergence.judged(runs, analysis),
        "indices": sensitivity.tables(runs, analysis),
        "confidence": verdicts.confidence(analysis),
        "sentences": sensitivity.sentences(runs, analysis),
    }
