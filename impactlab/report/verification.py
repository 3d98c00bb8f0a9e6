"""The report of a verification: the verdict first, failed checks before passed ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.draw import OVERVIEW
from impactlab.figures.labels import Display, display
from impactlab.report.answer import entries
from impactlab.report.page import Cell, Row, Table, described, pictures, write_page
from impactlab.verification.finding import Comparison, Outcome, gravest_first
from impactlab.verification.stored import unpacked

_SHORT = 12
"""Longest table of passed comparisons that is not folded."""
_HEAD = ["Quantity", "Case", "Ours", "Independent value", "Difference", "Tolerance", "Verdict"]
_DIGITS = 6
_PLAIN = ("absolute", "relative")
"""Measures that need no name beside the number: its unit, or none, shows them."""
_PERCENT = 1e-4
"""Smallest relative tolerance that is given in per cent."""


def tally(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """Count checks and comparisons, and those that did not pass."""
    return {
        "checks": len(outcomes),
        "bad_checks": sum(outcome.verdict != "passed" for outcome in outcomes),
        "comparisons": sum(len(outcome.finding.comparisons) for outcome in outcomes),
        "failed": sum(len(outcome.failures) for outcome in outcomes),
    }


def write_verification(findings: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a verification from its findings.nc and its figures.

    Raises FileNotFoundError when a figure is missing, OSError when `path` cannot be written.
    """
    outcomes = gravest_first(unpacked(findings))
    answer, note = entries(findings)
    drawn, found = pictures(figures_folder, made_from=findings), tally(outcomes)
    bad, checks = bool(found["bad_checks"]) or not outcomes, []
    for outcome in outcomes:
        passed = [_row(entry) for entry in outcome.finding.comparisons if entry.passed]
        failed = [_row(entry) for entry in outcome.failures]
        check = {
            "outcome": outcome,
            "failed": Table(f"Failed: {outcome.title}", _HEAD, failed),
            "passed": Table(f"Passed: {outcome.title}", _HEAD, passed),
            "short": len(passed) <= _SHORT,
            "picture": drawn.get(outcome.name),
        }
        checks.append(check)
    write_page(
        "verification.html.j2",
        path,
        **described(findings, "findings"),
        heading="Verification failed" if bad else "Verification passed",
        bad=bad,
        answers=answer,
        note=note,
        leading=drawn.get(OVERVIEW),
        facts=[labels.counted(found[f"{what}s"], what) for what in ("check", "comparison")],
        ending="",
        files="",
        anchors=[("summary", "All checks"), *((each.name, each.title) for each in outcomes)],
        summary=_summary(outcomes),
        checks=checks,
        command="verify",
        purpose="repeats these checks",
    )


def _summary(outcomes: Sequence[Outcome]) -> Table:
    """Return one row per check, with its worst comparison."""
    rows: list[Row] = []
    for outcome in outcomes:
        total, worst = len(outcome.finding.comparisons), outcome.worst
        bad = outcome.verdict != "passed"
        rows.append(
            [
                outcome.title,
                Cell(outcome.verdict.upper(), "warning") if bad else "passed",
                Cell(f"{total - len(outcome.failures)} of {total}", "number"),
                Cell(labels.number(worst.ratio, digits=2) if worst else "–", "number"),
                f"{worst.quantity}, {worst.where}" if worst else outcome.reason,
                Cell(f"{outcome.seconds:.1f} s", "number"),
            ]
        )
    head = [
        "Check",
        "Verdict",
        "Passed",
        "Largest error over tolerance",
        "Quantity and case of that error",
        "Time",
    ]
    return Table("All checks, failed ones first", head, rows)


def _row(entry: Comparison) -> Row:
    """Return a comparison: both values in one unit, error and tolerance in another."""
    unit = _display(entry, max(abs(entry.ours), abs(entry.independent)))
    if entry.measure == "absolute":
        gap_unit = _display(entry, entry.tolerance)
    else:
        gap_unit = Display(100.0, "%") if entry.tolerance >= _PERCENT else Display(1.0, "")
    measure = "" if entry.measure in _PLAIN else entry.measure
    return [
        labels.sentence(entry.quantity),
        entry.where,
        Cell(_value(entry.ours, unit, _DIGITS), "number"),
        Cell(_value(entry.independent, unit, _DIGITS), "number"),
        Cell(_value(entry.error, gap_unit, 2), "number", measure),
        Cell(_value(entry.tolerance, gap_unit, 2), "number"),
        "passed" if entry.passed else Cell("FAILED", "warning"),
    ]


def _display(entry: Comparison, magnitude: float) -> Display:
    name = entry.quantity.replace(" ", "_")
    return display(xr.DataArray([magnitude], attrs={"units": entry.units}, name=name))


def _value(value: float, unit: Display, digits: int) -> str:
    text = labels.number(float(unit(value)), digits)
    return f"{text} {unit.symbol}".strip() if np.isfinite(value) else text
