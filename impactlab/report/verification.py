"""The report of a verification: the verdict first, failed checks before passed ones."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.draw import OVERVIEW
from impactlab.figures.labels import Display, display
from impactlab.report.answer import entries
from impactlab.report.page import Cell, Row, Section, Table, described, pictures, write_page
from impactlab.verification.finding import Comparison, Outcome, gravest_first
from impactlab.verification.outcomes import unpacked

_SHORT = 12  # longest table of passed comparisons that is not folded
_HEAD = [
    "Quantity",
    "Case",
    "Ours",
    "Independent value",
    "Uncertainty of that",
    "Difference",
    "Tolerance",
    "Verdict",
]
_DIGITS = 6
_PLAIN = ("absolute", "relative")
"""Measures that need no name beside the number: its unit, or none, shows them."""
_PERCENT = 1e-4  # smallest relative tolerance that is given in per cent


def counts(findings: xr.Dataset) -> tuple[str, str]:
    """Return how many checks and comparisons there are, and how many failed ("": none)."""
    outcomes = unpacked(findings)
    bad = [outcome for outcome in outcomes if outcome.verdict != "passed"]
    total = sum(len(outcome.finding.comparisons) for outcome in outcomes)
    failed = sum(len(outcome.failures) for outcome in bad)
    size = f"{labels.counted(len(outcomes), 'check')}, {labels.counted(total, 'comparison')}"
    if outcomes and not bad:
        return size, ""
    checks, comparisons = labels.counted(len(bad), "check"), labels.counted(failed, "comparison")
    return size, f"{checks} and {comparisons} failed"


def write_verification(findings: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a verification from its findings.nc and its figures.

    Raises FileNotFoundError when a figure is missing, OSError when `path` cannot be written.
    """
    outcomes = gravest_first(unpacked(findings))
    headline, answer, note = entries(findings, None)
    size, failed = counts(findings)
    figures = pictures(figures_folder, made_from=findings)
    summary = Section("summary", "All checks", tables=[_summary(outcomes)])
    write_page(
        "report.html.j2",
        path,
        **described(findings, "findings"),
        heading="Verification failed" if failed else "Verification passed",
        bad=bool(failed),
        headline=headline,
        answers=answer,
        note=note,
        leading=figures.pop(OVERVIEW, None),
        facts=[size],
        ending=failed,
        pictures=figures,
        sections=[summary, *map(_section, outcomes)],
        command="verify",
        purpose="repeats these checks",
    )


def _section(outcome: Outcome) -> Section:
    """Return the section on one check: a failed one stands out, with its failures open."""
    lead = f"Independent values: {outcome.source}. Check {outcome.name}, {outcome.seconds:.1f} s."
    if outcome.reference:
        lead += f" Uncertainty of the independent values ({outcome.reference}): {outcome.basis}."
    title, notes, shown, folded = outcome.title, list[str](), list[Table](), list[Table]()
    if outcome.reason:
        notes = [f"An error ended this check, which compared nothing: {outcome.reason}"]
    elif not outcome.finding.comparisons:
        notes = ["This check compared nothing."]
    if failed := [_row(entry) for entry in outcome.failures]:
        shown.append(Table(f"Failed: {title}", _HEAD, failed))
    if passed := [_row(entry) for entry in outcome.finding.comparisons if entry.passed]:
        number = labels.counted(len(passed), "comparison")
        table = Table(f"Passed: {title} ({number})", _HEAD, passed)
        (shown if len(passed) <= _SHORT else folded).append(table)
    bad = outcome.verdict != "passed"
    if bad:
        title += f": {outcome.verdict}"
    return Section(outcome.name, title, lead, notes, shown, [outcome.name], folded, grave=bad)


def _summary(outcomes: Sequence[Outcome]) -> Table:
    rows: list[Row] = []
    for outcome in outcomes:
        total, worst = len(outcome.finding.comparisons), outcome.worst
        bad = outcome.verdict != "passed"
        row: Row = [
            outcome.title,
            Cell(outcome.verdict.upper(), "warning") if bad else "passed",
            Cell(f"{total - len(outcome.failures)} of {total}", "number"),
            Cell(labels.number(worst.ratio, digits=2) if worst else "–", "number"),
            f"{worst.quantity}, {worst.where}" if worst else outcome.reason,
            Cell(f"{outcome.seconds:.1f} s", "number"),
        ]
        rows.append(row)
    of_error = ["Largest error over tolerance", "Quantity and case of that error"]
    head = ["Check", "Verdict", "Passed", *of_error, "Time"]
    return Table("All checks, failed ones first", head, rows)


def _row(entry: Comparison) -> Row:
    """Return a comparison: both values in one unit, error and tolerance in another."""
    unit = _display(entry, max(abs(entry.ours), abs(entry.independent)))
    gap_unit = _gap_unit(entry)
    measure = "" if entry.measure in _PLAIN else entry.measure
    return [
        labels.sentence(entry.quantity),
        entry.where,
        Cell(_value(entry.ours, unit, _DIGITS), "number"),
        Cell(_value(entry.independent, unit, _DIGITS), "number"),
        Cell(uncertainty(entry), "number"),
        Cell(_value(entry.error, gap_unit, 2), "number", measure),
        Cell(_value(entry.tolerance, gap_unit, 2), "number"),
        "passed" if entry.passed else Cell("FAILED", "warning"),
    ]


def _gap_unit(entry: Comparison) -> Display:
    if entry.measure == "absolute":
        return _display(entry, entry.tolerance)
    return Display(100.0, "%") if entry.tolerance >= _PERCENT else Display(1.0, "")


def uncertainty(entry: Comparison) -> str:
    """Return the uncertainty of an independent value, in the unit of the error."""
    if np.isnan(entry.uncertainty):
        return "not known"
    return _value(entry.uncertainty, _gap_unit(entry), 2) if entry.uncertainty else "exact"


def _display(entry: Comparison, magnitude: float) -> Display:
    name = entry.quantity.replace(" ", "_")
    return display(xr.DataArray([magnitude], attrs={"units": entry.units}, name=name))


def _value(value: float, unit: Display, digits: int) -> str:
    text = labels.number(float(unit(value)), digits)
    return f"{text} {unit.symbol}".strip() if np.isfinite(value) else text
