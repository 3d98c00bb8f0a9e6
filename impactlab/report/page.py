"""Pages from templates: the records that templates print, and where the numbers come from."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

import xarray as xr
from jinja2 import Environment, PackageLoader, StrictUndefined

from impactlab.files import replaced

_PROVENANCE = {
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


@dataclass(frozen=True)
class Cell:
    """Text of one cell. kind: "", "number", "muted" or "warning"; detail: small print below."""

    text: str
    kind: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Table:
    """A caption, the column heads, and rows as wide as the head; the first cell heads its row."""

    caption: str
    head: list[str]
    rows: list[list[Cell]] = field(default_factory=list)


@dataclass(frozen=True)
class Section:
    """A heading and its content, in this order.

    name: the anchor. lead: a paragraph. sentences: a list. tables: shown in full. figures: names of
    figures (those that were not drawn are left out). folded: tables that the reader opens.
    files: names of files beside the page.
    """

    name: str
    title: str
    lead: str = ""
    sentences: list[str] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)
    folded: list[Table] = field(default_factory=list)
    files: list[str] = field(default_factory=list)


def write_page(template: str, path: Path, **context: Any) -> None:
    """Render a template of this package into a file, whole or not at all.

    Raises OSError where the folder cannot be written.
    """
    text = _environment().get_template(template).render(context)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def provenance(stored: xr.Dataset, what: str = "runs") -> Table:
    """Return one row per attribute of provenance that a stored dataset has."""
    rows = [
        [Cell(label), Cell(_shown(key, str(stored.attrs[key])))]
        for key, label in _PROVENANCE.items()
        if key in stored.attrs
    ]
    return Table(f"Provenance of the {what}", ["What", "Value"], rows)


def commands(
    stored: xr.Dataset, command: str = "run", purpose: str = "solves this study again"
) -> list[tuple[str, str]]:
    """Return pairs (command, what it does) that reproduce the runs, or everything."""
    name = stored.attrs.get("study", "NAME")
    return [
        (f"impactlab {command} studies/{name}.yaml", purpose),
        (f"make study STUDIES={name}", "reproduces its results, figures and this report"),
        ("make study", "reproduces all results, figures and reports"),
    ]


@cache
def _environment() -> Environment:
    """Return an environment that escapes every value and rejects misspelled names."""
    return Environment(
        loader=PackageLoader("impactlab.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def _shown(key: str, text: str) -> str:
    """Return a time in readable form; other texts, and times that are not ISO, unchanged."""
    if key != "created":  # a hash may look like a time
        return text
    try:
        return datetime.fromisoformat(text).strftime("%Y-%m-%d %H:%M:%S %Z").strip()
    except ValueError:
        return text
