"""The index of all reports."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import xarray as xr

from impactlab.figures.draw import CAPTIONS
from impactlab.figures.reading.contents import count
from impactlab.report.outcome import failed_runs
from impactlab.report.page import write_page


@dataclass(frozen=True)
class Entry:
    """A study in the index. report, thumbnail: addresses relative to the index ("" for none)."""

    study: str
    title: str
    description: str
    method: str
    runs: int
    failed: int
    report: str
    thumbnail: str
    alt: str


def write_index(results: Path, path: Path) -> None:
    """Write a page with a link to each report under `results` (results/NAME/report.html).

    A study without runs.nc beside its report is left out. Raises OSError when `path` cannot be
    written.
    """
    folders = [report.parent for report in sorted(results.glob("*/report.html"))]
    entries = [_entry(folder, path.parent) for folder in folders if (folder / "runs.nc").exists()]
    write_page("index.html.j2", path, entries=entries)


def _entry(folder: Path, home: Path) -> Entry:
    thumbnail, alt = _thumbnail(folder)
    with xr.open_dataset(folder / "runs.nc") as runs:
        return Entry(
            study=folder.name,
            title=str(runs.attrs.get("title") or folder.name),
            description=str(runs.attrs.get("description", "")),
            method=str(runs.attrs.get("method", "grid")),
            runs=count(runs),
            failed=int(failed_runs(runs).sum()),
            report=_address(folder / "report.html", home),
            thumbnail=_address(thumbnail, home) if thumbnail else "",
            alt=alt,
        )


def _thumbnail(folder: Path) -> tuple[Path | None, str]:
    """The study's first figure, and its title."""
    captions = folder / "figures" / CAPTIONS
    if captions.exists():
        for name, entry in json.loads(captions.read_bytes()).items():
            if (path := captions.with_name(f"{name}.svg")).exists():
                return path, str(entry["title"])
    return None, ""


def _address(path: Path, home: Path) -> str:
    return quote(Path(os.path.relpath(path, home)).as_posix())
