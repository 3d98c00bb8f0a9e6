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
    "kernels_sha256": "SHA-256 of the kernels",
    "study_sha256": "SHA-256 of the study file",
    "seed": "Seed of the sample",
    "base_samples": "Base samples",
    "trajectories": "Trajectories",
    "levels": "Levels",
    "harmonics": "Harmonics",
    "resamples": "Bootstrap resamples",
    "failed_runs": "Policy for failed runs",
}


def provenance(runs: xr.Dataset, what: str = "runs") -> Table:
    """A row for each attribute of provenance that the runs, or what else it is, have."""
    rows = [
        [Cell(label), Cell(_shown(key, str(runs.attrs[key])))]
        for key, label in _ATTRIBUTES.items()
        if key in runs.attrs
    ]
    return Table(f"Provenance of the {what}", ["What", "Value"], rows)


def commands(
    runs: xr.Dataset, command: str = "run", purpose: str = "solves this study again"
) -> list[tuple[str, str]]:
    """(command, what it does) to make the runs, or everything, again."""
    name = runs.attrs.get("study", "NAME")
    return [
        (f"impactlab {command} studies/{name}.yaml", purpose),
        (f"make study STUDIES={name}", "makes its results, figures and this report again"),
        ("make study", "makes all results, figures and reports"),
    ]


def _shown(key: str, text: str) -> str:
    """A time for reading; any other text, and what is no ISO time, as it is."""
    if key != "created":  # a hash may look like a time
        return text
    try:
        return datetime.fromisoformat(text).strftime("%Y-%m-%d %H:%M:%S %Z").strip()
    except ValueError:
        return text
