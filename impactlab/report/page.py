"""Pages from templates: the records that they print, where the numbers come from, how to cite.

Reports beside those of studies, such as of a calibration, tell the index of themselves.
"""

import base64
import csv
import json
import math
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from ruamel.yaml import YAML

from impactlab.figures import labels
from impactlab.figures.animation import FILE
from impactlab.figures.needs import REFINED
from impactlab.figures.record import CAPTIONS, LEAD, listed
from impactlab.files import identity, replaced
from impactlab.methods import FAMILIES

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
    "replicates": "Replicates of the sample",
    "resamples": "Bootstrap resamples",
    "failed_runs": "Policy for failed runs",
}
_LEADING = (
    LEAD,
    *(family.figure for family in FAMILIES),
    *(f"{axis}_convergence" for axis in dict.fromkeys(REFINED.values())),
    "parameter_effects",
    "compared_values",
)
"""Figures that answer a question, the first of a study before its others."""
_SCREEN, _SCREEN_OF_LEAD = 1.3, 1.6
"""Enlargement of figures, which are 8 pt at the width of a paper; on a screen that is small."""
_MOST = 80  # largest number of curve points in a table; bars with names are all listed
_COLUMNS = {
    "panel": "Panel",
    "curve": "Curve",
    "category": "Of",
    "x_label": "Horizontal axis (x)",
    "y_label": "Vertical axis (y)",
}


@dataclass(frozen=True)
class Cell:
    """Text of one cell. kind: "", "number", "muted" or "warning"; detail: small print below.

    link: a file that the text leads to, relative to the page.
    """

    text: str
    kind: str = ""
    detail: str = ""
    link: str = ""


Row = Sequence[Cell | str]
"""Cells, of which those with plain text alone need no record; the first one heads the row."""


Entry = tuple[str, str]
"""Subject and finding of a line of an answer."""


@dataclass(frozen=True)
class Table:
    """A caption, the column heads, and rows as wide as the head.

    remarks: paragraphs below it. meanings: words of its cells, each with its meaning.
    """

    caption: str
    head: list[str]
    rows: Sequence[Row] = ()
    remarks: Sequence[str] = ()
    meanings: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True)
class Section:
    """A heading and its content, in this order.

    name: the anchor. lead: a paragraph. sentences: a list. tables: shown in full. file: of all
    indices, beside the page. figures: names of figures (those that were not drawn are left out).
    folded: tables that the reader opens. grave: it stands out as a warning. closed: the reader
    opens the whole of it.
    """

    name: str
    title: str
    lead: str = ""
    sentences: list[str] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: Sequence[str] = ()
    folded: list[Table] = field(default_factory=list)
    file: str = ""
    grave: bool = False
    closed: bool = False


def write_page(
    template: str, path: Path, package: str = "impactlab.report", **context: Any
) -> None:
    """Render a template of a package, which may use those of this one, into a file.

    Its foot says how to cite the software, what the results were `made` from, and leads to the
    `index`, by default that of results/ from a page in results/NAME.
    The file is written whole or not at all. Raises OSError where the folder cannot be written.
    """
    foot = {"citation": how_to_cite(), "made": "", "index": "../index.html"}
    text = _environment(package).get_template(template).render(foot | context)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@cache
def _environment(package: str) -> Environment:
    """Return an environment that escapes every value and rejects misspelled names."""
    return Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("impactlab.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def described(stored: xr.Dataset, contents: str = "runs") -> dict[str, Any]:
    """Return what every page says of a study; contents: those of the dataset."""
    attrs = {key: str(stored.attrs.get(key, "")) for key in ("study", "description", "study_text")}
    title = str(stored.attrs.get("title") or attrs["study"])
    made = made_from(stored)
    return attrs | {"title": title, "made": made, "provenance": provenance(stored, contents)}


def provenance(stored: xr.Dataset, contents: str = "runs") -> Table:
    """Return one row per attribute of provenance that a stored dataset has."""
    shown = {key: str(stored.attrs[key]) for key in _PROVENANCE if key in stored.attrs}
    with suppress(KeyError, ValueError):  # a time that is not ISO stays as it is
        created = datetime.fromisoformat(shown["created"])
        shown["created"] = created.strftime("%Y-%m-%d %H:%M:%S %Z").strip()
    rows: list[Row] = [[_PROVENANCE[key], text] for key, text in shown.items()]
    return Table(f"Provenance of the {contents}", ["What", "Value"], rows)


def largest(results: xr.Dataset, variable: str, text: Any = labels.percent) -> Cell:
    """Return the largest number of a variable as text; a dash where it is not given."""
    value = float(results[variable].max()) if variable in results else np.nan
    return Cell("–" if np.isnan(value) else text(value), "number")


def pictures(
    folder: Path, placed: Sequence[str] = (), made_from: xr.Dataset | None = None
) -> dict[str, dict[str, Any]]:
    """Return what templates show of the figures in captions.json, numbered in the page's order.

    Each is an image of its own (`uri`), so that names inside SVGs cannot clash, with its width on a
    screen in CSS pixels, and its numbers, thinned (`data`; None for maps).

    The first belongs to the answer (`leading`); placed: names that come next, in order. Raises
    FileNotFoundError, saying what to do, when captions.json or a figure is not in the folder;
    ValueError when the figures were not drawn from the dataset made_from.
    """
    try:
        entries = listed(folder)
        svgs = {name: (folder / f"{name}.svg").read_bytes() for name in entries}
    except FileNotFoundError as error:
        raise FileNotFoundError(
            f"{error.filename} is missing: draw the figures again (impactlab figures)"
        ) from None
    if any(entry.get("made_from") != identity(made_from) for entry in entries.values()):
        again = "draw them again with `impactlab figures`"
        raise ValueError(f"{folder}: its figures were drawn from other results: {again}")
    order = {name: position for position, name in enumerate(placed)} | {leading(entries): -1}
    names = sorted(entries, key=lambda name: order.get(name, len(order)))
    figures: dict[str, dict[str, Any]] = {}
    for number, name in enumerate(names, 1):
        entry, svg = entries[name], svgs[name]
        screen = _SCREEN_OF_LEAD if name == LEAD else _SCREEN
        root = re.search(rb'<svg [^>]*?\bwidth="([\d.]+)pt"', svg)  # as matplotlib writes it
        numbers = folder / f"{name}.csv"
        figures[name] = entry | {
            "number": number,
            "name": name,
            "alt": f"{entry['title']}. {entry['alt']}".strip(),
            "uri": f"data:image/svg+xml;base64,{base64.b64encode(svg).decode('ascii')}",
            "width": round(float(root.group(1)) * 96 / 72 * screen) if root else 0,
            "data": drawn_data(numbers) if numbers.exists() else None,
        }
    return figures


def motion(folder: Path) -> str:
    """Return the page of the animation among the figures, "" where there is none."""
    page = folder / FILE
    return page.read_text("utf-8") if page.exists() else ""


def leading(names: Iterable[str]) -> str:
    """Return the name of the figure that answers a study's question; "" without any."""
    listed = list(names)
    return next((name for name in (*_LEADING, *listed) if name in listed), "")


def drawn_data(path: Path) -> Table:
    """Return one row per point: panel, curve, category and numbers; curves are thinned evenly.

    path: NAME.csv as written by figures/data.py. Raises OSError where it cannot be read.
    """
    with path.open(encoding="utf-8", newline="") as file:
        points = list(csv.DictReader(file))
    named = any(row["category"] for row in points)
    shown, axes = points, ["x"]
    if not named:
        step, axes = math.ceil(len(points) / _MOST), ["x", "y"]
        curves = groupby(points, key=lambda row: (row["panel"], row["curve"]))
        shown = [row for _, curve in curves for row in list(curve)[::step]]
    differ = {key: {row[key] for row in shown} for key in _COLUMNS}
    columns = [key for key in ("panel", "curve", "category") if differ[key] - {""}]
    columns += [key for key in ("x_label", "y_label") if len(differ[key]) > 1]
    head = [_COLUMNS[key] for key in columns]
    for axis in axes:  # its label where all panels share it, else its letter
        shared = differ[f"{axis}_label"]
        head.append(axis if len(shared) > 1 else max(shared, default="") or axis)
    rows = []
    for row in shown:
        numbers = (Cell(labels.number(float(row[axis])), "number") for axis in axes)
        rows.append([*(row[key] or "–" for key in columns), *numbers])
    part = "" if len(shown) == len(points) else f" ({len(shown)} of {len(points)} points)"
    return Table(f"Data as drawn{part}", head, rows)


_PACKAGE = Path(__file__).parents[1]


@cache
def read_citation() -> dict[str, Any]:
    """Return what CITATION.cff says."""
    file = _PACKAGE / "CITATION.cff"  # in a checkout it is beside the package
    entries: dict[str, Any] = YAML(typ="safe").load(
        file if file.exists() else _PACKAGE.with_name(file.name)
    )
    return entries


def author_name(author: dict[str, str]) -> str:
    """Return the name of a person, or of an organisation."""
    person = f"{author.get('given-names', '')} {author.get('family-names', '')}".strip()
    return person or author["name"]


def how_to_cite() -> str:
    """Return the request of CITATION.cff, and the entry that it asks for."""
    citation = read_citation()
    authors = ", ".join(map(author_name, citation["authors"]))
    title = f"{citation['title']}, version {citation['version']}"
    return f"{' '.join(citation['message'].split())} {authors}: {title}."


def made_from(stored: xr.Dataset) -> str:
    """Return which file and which version of the software made the results in a dataset."""
    attrs = {key: str(value) for key, value in stored.attrs.items()}
    file = attrs.get("study_file", "").replace("../", "") or f"the study {attrs.get('study', '?')}"
    digest = f" (SHA-256 {attrs['study_sha256'][:12]}…)" if "study_sha256" in attrs else ""
    version = attrs.get("versions", "impactlab").split(",")[0]
    revision = f", revision {attrs['source_revision']}" if "source_revision" in attrs else ""
    return f"Made from {file}{digest} by {version}{revision}."


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
