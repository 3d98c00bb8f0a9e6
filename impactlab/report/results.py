"""Stored results of a study: their kinds, how each is drawn and reported, and an index of all."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import xarray as xr

from impactlab.figures.draw import draw_all, draw_findings
from impactlab.figures.record import CAPTIONS, listed
from impactlab.files import check_source, checked, identity, opened, read_netcdf
from impactlab.model.checks import did_you_mean
from impactlab.report import study, verification
from impactlab.report.answer import answers
from impactlab.report.page import described, leading, listed_reports, write_page


@dataclass(frozen=True)
class Kind:
    """One kind of results.

    files: stored beside the report; the first holds the study's title. draw(*datasets, folder,
    write): draw the figures, by default into the files of a report. write(*datasets,
    figures_folder, path): write the report. counts(dataset of the first file): return how much
    there is and what failed ("" for nothing).
    """

    files: tuple[str, ...]
    draw: Callable[..., list[Path]]
    write: Callable[..., object]
    counts: Callable[[xr.Dataset], tuple[str, str]]


RUNS = Kind(("runs.nc", "analysis.nc"), draw_all, study.write_report, study.counts)
COMPARISON = "comparison.nc"
"""The file of studies side by side, see report.comparison."""
FINDINGS = Kind(
    ("findings.nc",), draw_findings, verification.write_verification, verification.counts
)


def stored_files(folder: Path) -> list[Path]:
    """List the result files of a study. Raises FileNotFoundError if there are none."""
    for kind in (RUNS, FINDINGS):
        if (folder / kind.files[0]).exists():
            return [folder / name for name in kind.files]
    command = f"impactlab go studies/{folder.name}.yaml"
    files = (path for kind in (RUNS, FINDINGS) for path in folder.parent.glob(f"*/{kind.files[0]}"))
    near = did_you_mean(folder.name, sorted(path.parent.name for path in files))
    raise FileNotFoundError(f"{folder}: holds no results{near or f': make them with `{command}`'}")


_FILES = ("report", "thumbnail")  # keys of an entry of the index: files, seen from its page


@contextmanager
def open_stored(paths: Sequence[Path]) -> Iterator[tuple[Kind, list[xr.Dataset]]]:
    """Give the kind of a study's results, and their datasets, runs as `files.checked` in blocks.

    Raises OSError naming a file that cannot be read, ValueError where files are missing or too
    many, were changed, or do not belong together.
    """
    with checked(paths[0], "runs", "findings", blocks=True) as first:
        kind = FINDINGS if first.attrs["content"] == "findings" else RUNS
        if len(paths) != len(kind.files):
            expected = " and ".join(kind.files)
            raise ValueError(f"{paths[0]}: expected {expected}, but got {len(paths)} files")
        if kind is FINDINGS:
            yield kind, [first.load()]
        else:
            analysis = read_netcdf(paths[1], "analysis")
            check_source(analysis, paths[1], first, paths[0])
            yield kind, [first, analysis]


def _entry(report: Path) -> dict[str, Any] | None:
    """Return what the index says of a report; None without the results that it was made from.

    `compared` lists the studies of a comparison, none for other reports.
    """
    if (file := report.with_name(COMPARISON)).exists():
        comparison = read_netcdf(file, "comparison")
        names = np.atleast_1d(comparison.attrs["studies"]).tolist()
        made_from = comparison.attrs["made_from"].split()
        for name in names:
            analysis = report.parents[1] / name / RUNS.files[1]
            if not analysis.exists():
                return None
            with opened(analysis, "analysis") as stored:
                if identity(stored) not in made_from:
                    return None
        answer, size = answers(comparison)[0], f"{len(names)} studies side by side"
        return described(comparison) | {"size": size, "answer": answer, "compared": names}
    for kind in (RUNS, FINDINGS):
        files = [*map(report.with_name, kind.files)]
        if not files[0].exists():
            continue
        with opened(files[0], "runs", "findings"):
            pass  # another program's file is named, not left out
        try:
            with open_stored(files) as (_, datasets):
                size, failed = kind.counts(datasets[0])
                entry = described(datasets[0]) | {"size": size, "failed": failed, "compared": []}
                return entry | {"answer": answers(*datasets)[0]}
        except (OSError, ValueError):  # no analysis, that of other runs, or damaged
            return None
    return None


def write_index(results: Path, path: Path) -> None:
    """Write a page with each report under `results` (results/NAME/report.html): link and answer.

    The studies of a comparison follow it in its order; all else is in the order of names, reports
    of calibrations and 3-D runs after that of their study. The page on the paper (results/paper) is
    linked where it exists. A report without the stored results that it was made from is left out.
    Raises OSError when `path` cannot be written.
    """

    def address(target: Path) -> str:
        return quote(Path(os.path.relpath(target, path.parent)).as_posix())

    entries, places = [], dict[str, tuple[str, int]]()
    for report in sorted(results.glob("*/report.html")):
        if (entry := _entry(report)) is None:
            continue
        for place, name in enumerate(entry.pop("compared")):
            places.setdefault(name, (report.parent.name, place + 1))
        figures = report.with_name("figures")
        captions = listed(figures) if (figures / CAPTIONS).exists() else {}
        name = leading(captions)  # the figure that answers the study's question
        entry |= {"study": report.parent.name, "report": address(report)}
        if (figures / f"{name}.svg").exists():
            picture = address(figures / f"{name}.svg")
            entry |= {"thumbnail": picture, "alt": captions[name]["title"]}
        entries.append(entry)
    for folder, entry in listed_reports(results):
        files = {key: address(folder / entry[key]) for key in _FILES if key in entry}
        entries.append(entry | files)
    entries.sort(key=lambda entry: places.get(entry["study"], (entry["study"], 0)))
    claims = results / "paper" / "claims.html"
    paper = address(claims) if claims.exists() else ""
    write_page("index.html.j2", path, entries=entries, paper=paper, index="")
