"""The answer to the paper: its figures, claims.html, claims.csv and numbers.csv in one folder."""

from __future__ import annotations

import csv
import logging
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import count
from impactlab.figures.labels import Display, display
from impactlab.files import replaced
from impactlab.paper.figures import Stored, draw_paper
from impactlab.paper.statements import judge_all
from impactlab.paper.statements.statement import (
    Data,
    JudgedStatement,
    Judgement,
    Number,
    Statement,
    Verdict,
)
from impactlab.report.page import Cell, Table, provenance, write_page
from impactlab.report.pictures import pictures
from impactlab.study.netcdf import read_netcdf
from impactlab.variables import provenance as made_now

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Section:
    """One statement on the page."""

    statement: Statement
    table: Table


def write_paper(folders: Sequence[Path], output: Path) -> None:
    """Draw the figures, judge the statements, and write both to the folder `output`.

    folders: runs.nc and analysis.nc of one study each, under the study's name. Raises OSError
    where a file cannot be read or written.
    """
    stored = _read_studies(folders)
    runs = {name: runs for name, (runs, _) in stored.items()}
    judged = judge_all(runs)
    statements = [entry for entry in judged if not entry.statement.holds]
    misprints = [entry for entry in judged if entry.statement.holds]
    draw_paper(stored, output / "figures")
    _write_claims(judged, output / "claims.csv")
    _write_numbers(judged, output / "numbers.csv")
    write_page(
        "claims.html.j2",
        output / "claims.html",
        overviews=[_overview(statements), _misprints(misprints)],
        statements=[_section(entry) for entry in statements],
        misprints=[_section(entry) for entry in misprints],
        pictures=pictures(output / "figures"),
        tally=_tally(statements),
        solved=_solved(runs),
        provenance=provenance(xr.Dataset(attrs=made_now()), "page"),
    )


def _read_studies(folders: Sequence[Path]) -> Stored:
    stored: dict[str, tuple[xr.Dataset, xr.Dataset]] = {}
    for folder in folders:
        paths = folder / "runs.nc", folder / "analysis.nc"
        if all(path.exists() for path in paths):
            stored[folder.name] = (read_netcdf(paths[0]), read_netcdf(paths[1]))
        else:
            log.warning("%s holds no runs.nc with an analysis.nc: it is left out", folder)
    return stored


def _section(entry: JudgedStatement) -> Section:
    """Return a statement with one row per case."""
    head = ["Case or reading", "Our number", "Verdict", "Why"]
    rows = [
        [
            Cell(judgement.case),
            Cell(_numbers_text(judgement) or "–"),
            Cell(str(judgement.verdict), _class(judgement.verdict)),
            Cell(judgement.why),
        ]
        for judgement in entry.judgements
    ]
    return Section(entry.statement, Table("Judged cases", head, rows))


def _class(verdict: Verdict) -> str:
    return "warning" if verdict in (Verdict.FAILS, Verdict.UNKNOWN) else ""


def _overview(judged: Sequence[JudgedStatement]) -> Table:
    """Return one row per statement: the number of its cases with each verdict."""
    head = ["Statement of the paper", *(labels.sentence(verdict) for verdict in Verdict)]
    rows = []
    for entry in judged:
        counts = Counter(judgement.verdict for judgement in entry.judgements)
        cells = (Cell(str(counts[verdict] or "–"), "number") for verdict in Verdict)
        rows.append([Cell(entry.statement.text), *cells])
    return Table("Statements: number of cases or readings with each verdict", head, rows)


def _misprints(judged: Sequence[JudgedStatement]) -> Table:
    """Return one row per misprint: the print, what holds, and the verdict on the print."""
    head = ["Printed, or left open", "What holds", "Verdict on the print"]
    rows = [
        [
            Cell(entry.statement.text),
            Cell(entry.statement.holds),
            Cell(entry.judgements[0].verdict, detail=entry.statement.name),
        ]
        for entry in judged
    ]
    return Table("Misprints and open points of the paper", head, rows)


def _tally(judged: Iterable[JudgedStatement]) -> list[tuple[int, str]]:
    """Return the number of cases with each verdict."""
    counts = Counter(judgement.verdict for entry in judged for judgement in entry.judgements)
    return [(counts[verdict], str(verdict)) for verdict in Verdict]


def _solved(data: Data) -> Table:
    """Return one row per study: its runs, and where they come from."""
    head = ["Study", "Title", "Runs", "Solved", "Source revision"]
    rows = [
        [
            Cell(name),
            Cell(str(runs.attrs.get("title", ""))),
            Cell(str(count(runs)), "number"),
            Cell(str(runs.attrs.get("created", ""))),
            Cell(str(runs.attrs.get("source_revision", ""))),
        ]
        for name, runs in data.items()
    ]
    return Table("Studies that the verdicts are computed from", head, rows)


def _write_claims(judged: Iterable[JudgedStatement], path: Path) -> None:
    """Write one row per judgement, with its numbers as text."""
    head = ["claim", "statement", "case", "test", "numbers", "verdict", "why"]
    rows = (
        [
            entry.statement.name,
            entry.statement.text,
            judgement.case,
            entry.statement.test,
            _numbers_text(judgement),
            str(judgement.verdict),
            judgement.why,
        ]
        for entry in judged
        for judgement in entry.judgements
    )
    _write(path, head, rows)


def _write_numbers(judged: Iterable[JudgedStatement], path: Path) -> None:
    """Write one row per number, in SI units; an unknown uncertainty is "nan"."""
    head = ["claim", "case", "number", "value", "uncertainty", "units"]
    rows = (
        [
            entry.statement.name,
            judgement.case,
            number.name,
            f"{number.value:.9g}",
            f"{number.uncertainty:.3g}",
            number.units,
        ]
        for entry in judged
        for judgement in entry.judgements
        for number in judgement.numbers
    )
    _write(path, head, rows)


def _write(path: Path, head: list[str], rows: Iterable[list[str]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def _numbers_text(judgement: Judgement) -> str:
    return "; ".join(map(_number_text, judgement.numbers))


def _number_text(number: Number) -> str:
    """Return name, value and uncertainty: "peak force: 12.34 ± 0.11 kN"."""
    unit = _unit(number)
    value, width = float(unit(number.value)), float(unit(number.uncertainty))
    text = labels.number(value, _digits(value, width))
    if width:
        text = f"{text} ± {labels.number(width, 2) if np.isfinite(width) else 'unknown'}"
    return f"{number.name}: {text} {unit.symbol}".strip()


def _unit(number: Number) -> Display:
    if number.percent:
        return Display(100.0, "%")
    return display(xr.DataArray([number.value], attrs={"units": number.units}))


def _digits(value: float, width: float) -> int:
    """Return the significant digits down to the second of the uncertainty, 2 to 5."""
    if not (value and width and np.isfinite(value) and np.isfinite(width)):
        return 5
    value_power, width_power = np.floor(np.log10([abs(value), width]))
    return int(np.clip(value_power - width_power + 2, 2, 5))
