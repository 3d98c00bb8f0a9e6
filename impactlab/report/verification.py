"""The report of a verification: the verdict first, what failed before what passed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from impactlab.figures import labels
from impactlab.figures.draw import OVERVIEW
from impactlab.report import comparisons, provenance
from impactlab.report.page import write_page
from impactlab.report.pictures import Picture, pictures
from impactlab.report.table import Cell, Table
from impactlab.verification.finding import Outcome, gravest_first
from impactlab.verification.stored import unpacked

_SHORT = 12
"""Tables of up to so many passed comparisons stand open."""


@dataclass(frozen=True)
class Section:
    """A check on the page: tables of what failed and passed, and its curves."""

    outcome: Outcome
    failed: Table
    passed: Table
    picture: Picture | None

    @property
    def short(self) -> bool:
        """Whether the passed comparisons need no folding."""
        return len(self.passed.rows) <= _SHORT


@dataclass(frozen=True)
class Tally:
    """How many checks and comparisons there are, and how many of them did not pass."""

    checks: int
    bad_checks: int
    comparisons: int
    failed: int

    @property
    def passed(self) -> bool:
        """Whether there is a check, and all pass."""
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
    context = _about(findings) | {
        "tally": tally(outcomes),
        "bad": [outcome for outcome in outcomes if outcome.verdict != "passed"],
        "summary": _summary(outcomes),
        "overview": drawn.get(OVERVIEW),
        "sections": [_section(outcome, drawn.get(outcome.name)) for outcome in outcomes],
    }
    write_page("verification.html.j2", path, **context)


def _about(findings: xr.Dataset) -> dict[str, Any]:
    name = str(findings.attrs.get("study", "verification"))
    return {
        "title": str(findings.attrs.get("title") or name),
        "description": str(findings.attrs.get("description", "")),
        "provenance": provenance.provenance(findings, "findings"),
        "commands": provenance.commands(findings, "verify", "makes these checks again"),
        "study_text": str(findings.attrs.get("study_text", "")),
    }


def _section(outcome: Outcome, picture: Picture | None) -> Section:
    passed = [entry for entry in outcome.finding.comparisons if entry.passed]
    return Section(
        outcome,
        comparisons.table(f"Failed: {outcome.title}", outcome.failures),
        comparisons.table(f"Passed: {outcome.title}", passed),
        picture,
    )


def _summary(outcomes: Sequence[Outcome]) -> Table:
    head = ["Check", "Verdict", "Passed", "Largest error over tolerance", "It is that of", "Time"]
    return Table("Checks, what failed first", head, [_row(outcome) for outcome in outcomes])


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
