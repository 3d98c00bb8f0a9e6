"""Reports beside those of studies, such as of a calibration: each tells the index of itself."""

import json
import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.figures.record import CAPTIONS
from impactlab.files import replaced
from impactlab.report.page import Entry, Section, described, motion, pictures, write_page

_SUFFIX = ".index.json"
_KEYS = {"title", "study", "answer", "description", "size", "report"}
"""What the index prints of a report; it may have `failed`, `thumbnail` and `alt` as well."""


def write_listed(
    path: Path,
    stored: xr.Dataset,
    figures_folder: Path,
    *,
    headline: str,
    answers: Sequence[Entry],
    sections: Sequence[Section],
    size: str,
    failed: str = "",
    note: str = "",
    reproduce: Sequence[tuple[str, str]],
    index: Path,
) -> None:
    """Write a report, and beside it what the index of all results says of it.

    stored: has the attributes of a study that `described` takes. headline: without full stop; size,
    failed: how much there is, and what failed ("" for nothing). note: on the numbers. reproduce:
    commands with what each does. index: the page of all results. Figures that were not drawn are
    left out. Raises OSError where a file cannot be written.
    """
    drawn = (figures_folder / CAPTIONS).exists()
    figures = pictures(figures_folder) if drawn else {}
    files = os.path.relpath(figures_folder, path.parent)
    about, first = described(stored, str(stored.attrs.get("content", "results"))), None
    for name in list(figures)[:1]:
        first = figures.pop(name)
    write_page(
        "report.html.j2",
        path,
        **about,
        headline=headline,
        answers=[[entry] for entry in answers],
        note=note,
        bad=bool(failed),
        leading=first,
        facts=[size],
        ending=failed,
        pictures=figures,
        files=files,
        sections=[
            *sections,
            *([Section("figures", "Figures", figures=[*figures])] * bool(figures)),
        ],
        reproduce=reproduce,
        index=os.path.relpath(index, path.parent),
        animation=motion(figures_folder),
    )
    keys = ("title", "study", "description")
    entry = {key: about[key] for key in keys} | {"answer": f"{headline}.", "size": size}
    entry |= {"report": path.name} | ({"failed": failed} if failed else {})
    if first:
        entry |= {"thumbnail": f"{files}/{first['name']}.svg", "alt": first["title"]}
    with replaced(path.with_suffix(_SUFFIX)) as unfinished:
        unfinished.write_text(json.dumps(entry, ensure_ascii=False), "utf-8")


def listed_reports(results: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Yield folder and entry of each such report in results/NAME, or one folder further in.

    `report` and `thumbnail` of an entry are seen from the folder; a damaged one is left out.
    """
    for file in sorted([*results.glob(f"*/*{_SUFFIX}"), *results.glob(f"*/*/*{_SUFFIX}")]):
        with suppress(OSError, ValueError, TypeError, AttributeError):
            entry = json.loads(file.read_bytes())
            if entry.keys() >= _KEYS and (file.parent / entry["report"]).exists():
                yield file.parent, entry
