"""The report of a verification: the verdict first, failed checks before passed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.draw import OVERVIEW
from impactlab.figures.labels import Display, display
from impactlab.report.page import Cell, Table, commands, provenance, write_page
from impactlab.report.pictures import Picture, pictures
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


@dataclass(frozen=True)
class CheckResult:
    """A check on the page: tables of failed and passed comparisons, and its curves."""

    outcome: Outcome
    failed: Table
    passed: Table
    picture: Picture | None

    @property
    def short(self) -> bool:
        """Return whether the passed comparisons need no folding."""
        return len(self.passed.rows) <= _SHORT


@dataclass(frozen=True)
class Tally:
    """Numbers of checks and comparisons, and of those that did not pass."""

    checks: int
    bad_checks: int
    comparisons: int
    failed: int

    @property
    def passed(self) -> bool:
        """Return whether there is a check, and all pass."""
        return self.checks > 0 and self.bad_checks == 0


def tally(outcomes: Sequence[Outcome]) -> Tally:
    """Count checks and comparisons."""
    bad = sum(outcome.verdict != "passed" for outcome in outcomes)
    total = sum(len(outcome.finding.comparisons) for outcome in outcomes)
    return Tally(len(outcomes), bad, total, sum(len(outcome.failures) for outcome in outcomes))


def write_verification(findings: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a verification from its findings.nc and its figures.

    Raises FileNotFoundError when a figure is missing, OSError when `path` cannot be written.
    """
    outcomes = gravest_first(unpacked(findings))
    drawn = {picture.name: picture for picture in pictures(figures_folder)}
    name = str(findings.attrs.get("study", "verification"))
    write_page(
        "verification.html.j2",
        path,
        title=str(findings.attrs.get("title") or name),
        description=str(findings.attrs.get("description", "")),
        tally=tally(outcomes),
        bad=[outcome for outcome in outcomes if outcome.verdict != "passed"],
        summary=_summary(outcomes),
        overview=drawn.get(OVERVIEW),
        checks=[_check(outcome, drawn.get(outcome.name)) for outcome in outcomes],
        provenance=provenance(findings, "findings"),
        commands=commands(findings, "verify", "repeats these checks"),
        study_text=str(findings.attrs.get("study_text", "")),
    )


def _check(outcome: Outcome, picture: Picture | None) -> CheckResult:
    passed = [entry for entry in outcome.finding.comparisons if entry.passed]
    return CheckResult(
        outcome,
        Table(f"Failed: {outcome.title}", _HEAD, [_comparison(one) for one in outcome.failures]),
        Table(f"Passed: {outcome.title}", _HEAD, [_comparison(one) for one in passed]),
        picture,
    )


def _summary(outcomes: Sequence[Outcome]) -> Table:
    head = [
        "Check",
        "Verdict",
        "Passed",
        "Largest error over tolerance",
        "Quantity and case of that error",
        "Time",
    ]
    return Table("All checks, failed ones first", head, [_row(outcome) for outcome in outcomes])


def _row(outcome: Outcome) -> list[Cell]:
    total, worst = len(outcome.finding.comparisons), outcome.worst
    bad = outcome.verdict != "passed"
    return [
        Cell(outcome.title),
        Cell(outcome.verdict.upper(), "warning") if bad else Cell("passed"),
        Cell(f"{total - len(outcome.failures)} of {total}", "number"),
        Cell(labels.number(worst.ratio, digits=2) if worst else "–", "number"),
        Cell(f"{worst.quantity}, {worst.where}" if worst else outcome.reason),
        Cell(f"{outcome.seconds:.1f} s", "number"),
    ]


def _comparison(entry: Comparison) -> list[Cell]:
    unit = _display(entry, max(abs(entry.ours), abs(entry.independent)))
    error, tolerance = _gap(entry)
    return [
        Cell(labels.sentence(entry.quantity)),
        Cell(entry.where),
        Cell(_value(entry.ours, unit, _DIGITS), "number"),
        Cell(_value(entry.independent, unit, _DIGITS), "number"),
        Cell(error, "number", "" if entry.measure in _PLAIN else entry.measure),
        Cell(tolerance, "number"),
        Cell("passed") if entry.passed else Cell("FAILED", "warning"),
    ]


def _gap(entry: Comparison) -> tuple[str, str]:
    """Return error and tolerance as text, in the same unit."""
    if entry.measure == "absolute":
        unit = _display(entry, entry.tolerance)
    else:
        unit = Display(100.0, "%") if entry.tolerance >= _PERCENT else Display(1.0, "")
    return _value(entry.error, unit, 2), _value(entry.tolerance, unit, 2)


def _value(value: float, unit: Display, digits: int) -> str:
    text = labels.number(float(unit(value)), digits)
    return f"{text} {unit.symbol}".strip() if np.isfinite(value) else text


def _display(entry: Comparison, magnitude: float) -> Display:
    name = entry.quantity.replace(" ", "_")
    return display(xr.DataArray([magnitude], attrs={"units": entry.units}, name=name))
