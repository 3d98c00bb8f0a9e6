"""Judged statements as tables: for the page, and as CSV."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import count
from impactlab.figures.files import replaced
from impactlab.figures.labels import Display, display
from impactlab.paper.statements.catalogue import Claim
from impactlab.paper.statements.claim import Judgement, Number, Verdict
from impactlab.report.table import Cell, Table

_PERCENT = ("error of", "PEEQ", "jump of")
"""Beginnings of the names of numbers that are told in %."""
_BAD = (Verdict.FAILS, Verdict.UNKNOWN)


@dataclass(frozen=True)
class Section:
    """One statement on the page."""

    claim: Claim
    table: Table


def section(claim: Claim) -> Section:
    """A statement with a row a case."""
    head = ["Case or reading", "Our number", "Verdict", "Why"]
    rows = [
        [
            Cell(entry.case),
            Cell("; ".join(map(_told, entry.numbers)) or "–"),
            _verdict(entry),
            Cell(entry.why),
        ]
        for entry in claim.judgements
    ]
    return Section(claim, Table("Judged cases", head, rows))


def overview(caption: str, claims: Sequence[Claim]) -> Table:
    """A row a statement: how many of its cases came to which verdict."""
    head = ["Statement of the paper", *(labels.sentence(verdict) for verdict in Verdict)]
    rows = []
    for claim in claims:
        found = Counter(entry.verdict for entry in claim.judgements)
        rows.append([Cell(claim.says), *(Cell(str(found[v] or "–"), "number") for v in Verdict)])
    return Table(f"{caption}: number of cases or readings with each verdict", head, rows)


def misprints(claims: Sequence[Claim]) -> Table:
    """A row a misprint: what is printed, what holds, and what the check says of the print."""
    head = ["Printed, or left open", "Holds", "The check of it"]
    rows = [
        [Cell(claim.says), Cell(claim.holds), Cell(claim.judgements[0].verdict, detail=claim.name)]
        for claim in claims
    ]
    return Table("Misprints and open points of the paper", head, rows)


def tally(claims: Iterable[Claim]) -> list[tuple[int, str]]:
    """How many cases came to each verdict."""
    found = Counter(entry.verdict for claim in claims for entry in claim.judgements)
    return [(found[verdict], str(verdict)) for verdict in Verdict]


def solved(data: Mapping[str, xr.Dataset]) -> Table:
    """A row a study that the page takes: its runs, and where they come from."""
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


def write_csv(claims: Iterable[Claim], path: Path) -> None:
    """A row a judgement, numbers in words."""
    head = ["claim", "statement", "case", "test", "numbers", "verdict", "why"]
    rows = (
        [
            claim.name,
            claim.says,
            entry.case,
            claim.test,
            "; ".join(map(_told, entry.numbers)),
            str(entry.verdict),
            entry.why,
        ]
        for claim in claims
        for entry in claim.judgements
    )
    _write(path, head, rows)


def write_numbers(claims: Iterable[Claim], path: Path) -> None:
    """A row a number, in SI units; an uncertainty that is not known is "nan"."""
    head = ["claim", "case", "number", "value", "uncertainty", "units"]
    rows = (
        [claim.name, entry.case, n.name, f"{n.value:.9g}", f"{n.uncertainty:.3g}", n.units]
        for claim in claims
        for entry in claim.judgements
        for n in entry.numbers
    )
    _write(path, head, rows)


def _write(path: Path, head: list[str], rows: Iterable[list[str]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def _verdict(entry: Judgement) -> Cell:
    return Cell(str(entry.verdict), "warning" if entry.verdict in _BAD else "")


def _told(number: Number) -> str:
    """Name, value and uncertainty: "peak force: 12.34 ± 0.11 kN"."""
    unit = _unit(number)
    value, width = float(unit(number.value)), float(unit(number.uncertainty))
    text = labels.number(value, _digits(value, width))
    if width:
        text = f"{text} ± {labels.number(width, 2) if np.isfinite(width) else 'unknown'}"
    return f"{number.name}: {text} {unit.symbol}".strip()


def _unit(number: Number) -> Display:
    if number.units == "1" and number.name.startswith(_PERCENT):
        return Display(100.0, "%")
    return display(xr.DataArray([number.value], attrs={"units": number.units}))


def _digits(value: float, width: float) -> int:
    """Significant digits down to the second of the uncertainty, 2 to 5."""
    if not (value and width and np.isfinite(value) and np.isfinite(width)):
        return 5
    value_power, width_power = np.floor(np.log10([abs(value), width]))
    return int(np.clip(value_power - width_power + 2, 2, 5))
