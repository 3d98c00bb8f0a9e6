"""Stored results of a study: their kinds, how each is drawn and reported, and an index of all."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import xarray as xr

from impactlab.figures.draw import draw_all, draw_findings
from impactlab.figures.record import CAPTIONS, listed
from impactlab.files import check_source, checked, read_netcdf
from impactlab.report import study, verification
from impactlab.report.answer import answers
from impactlab.report.page import described, leading, write_page


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
FINDINGS = Kind(
    ("findings.nc",), draw_findings, verification.write_verification, verification.counts
)


def stored_files(folder: Path) -> list[Path]:
    """Return the files of a study's results. Raises FileNotFoundError where there are none."""
    for kind in (RUNS, FINDINGS):
        if (folder / kind.files[0]).exists():
            return [folder / name for name in kind.files]
    command = f"impactlab go studies/{folder.name}.yaml"
    raise FileNotFoundError(f"{folder}: holds no results: make them with `{command}`")


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


def write_index(results: Path, path: Path) -> None:
    """Write a page with each report under `results` (results/NAME/report.html): link and answer.

    The page on the paper (results/paper) is linked where it exists. A report without the stored
    results that it was made from is left out. Raises OSError when `path` cannot be written.
    """

    def address(target: Path) -> str:
        return quote(Path(os.path.relpath(target, path.parent)).as_posix())

    entries = []
    for report in sorted(results.glob("*/report.html")):
        for kind in (RUNS, FINDINGS):
            if report.with_name(kind.files[0]).exists():
                try:
                    with open_stored([*map(report.with_name, kind.files)]) as (_, datasets):
                        size, failed = kind.counts(datasets[0])
                        entry = described(datasets[0]) | {"size": size, "failed": failed}
                        entry["answer"] = answers(*datasets)[0]
                except (OSError, ValueError):  # no analysis, that of other runs, or damaged
                    continue
                figures = report.with_name("figures")
                captions = listed(figures) if (figures / CAPTIONS).exists() else {}
                name = leading(captions)  # the figure that answers the study's question
                entry |= {"study": report.parent.name, "report": address(report)}
                if (figures / f"{name}.svg").exists():
                    picture = address(figures / f"{name}.svg")
                    entry |= {"thumbnail": picture, "alt": captions[name]["title"]}
                entries.append(entry)
                break
    claims = results / "paper" / "claims.html"
    paper = address(claims) if claims.exists() else ""
    write_page("index.html.j2", path, entries=entries, paper=paper, index="")
