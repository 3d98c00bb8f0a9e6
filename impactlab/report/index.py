"""The index of all reports."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import xarray as xr

from impactlab.figures.draw import CAPTIONS
from impactlab.report.kinds import Kind, kind_in
from impactlab.report.page import write_page


@dataclass(frozen=True)
class Entry:
    """A study in the index.

    size: how much there is; failed: what failed ("" for nothing). report, thumbnail: addresses
    relative to the index ("" for none).
    """

    study: str
    title: str
    description: str
    size: str
    failed: str
    report: str
    thumbnail: str
    alt: str


def write_index(results: Path, path: Path) -> None:
    """Write a page with a link to each report under `results` (results/NAME/report.html).

    The page on the paper (results/paper) is linked where it is. A report without the stored
    results that it was made from is left out. Raises OSError when `path` cannot be written.
    """
    folders = [report.parent for report in sorted(results.glob("*/report.html"))]
    entries = [_entry(folder, kind, path.parent) for folder in folders if (kind := kind_in(folder))]
    claims = results / "paper" / "claims.html"
    address = _address(claims, path.parent) if claims.exists() else ""
    write_page("index.html.j2", path, entries=entries, paper=address)


def _entry(folder: Path, kind: Kind, home: Path) -> Entry:
    thumbnail, alt = _thumbnail(folder)
    with xr.open_dataset(folder / kind.files[0]) as stored:
        size, failed = kind.listed(stored)
        return Entry(
            study=folder.name,
            title=str(stored.attrs.get("title") or folder.name),
            description=str(stored.attrs.get("description", "")),
            size=size,
            failed=failed,
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
