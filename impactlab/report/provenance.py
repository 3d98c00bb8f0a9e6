"""Where the numbers come from, and the commands that make them again."""

from __future__ import annotations

from datetime import datetime

import xarray as xr

from impactlab.report.table import Cell, Table

_ATTRIBUTES = {
    "created": "Solved",
    "source_revision": "Source revision",
    "versions": "Versions",
    "processor": "Processor",
    "study_sha256": "SHA-256 of the study file",
    "seed": "Seed of the sample",
    "base_samples": "Base samples",
}


def provenance(runs: xr.Dataset) -> Table:
    """A row for each attribute of provenance that the runs have."""
    rows = [
        [Cell(label), Cell(_moment(str(runs.attrs[key])))]
        for key, label in _ATTRIBUTES.items()
        if key in runs.attrs
    ]
    return Table("Provenance of the runs", ["What", "Value"], rows)


def commands(runs: xr.Dataset) -> list[tuple[str, str]]:
    """(command, what it does) to make the runs, or everything, again."""
    name = runs.attrs.get("study", "NAME")
    return [
        (f"impactlab run studies/{name}.yaml", "solves this study again"),
        ("make study", "makes all results, figures and reports"),
    ]


def _moment(text: str) -> str:
    """An ISO time for reading; any other text as it is."""
    try:
        return datetime.fromisoformat(text).strftime("%Y-%m-%d %H:%M:%S %Z").strip()
    except ValueError:
        return text
