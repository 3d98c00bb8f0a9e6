"""What the command line prints: tables for a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.filesize import decimal
from rich.markup import escape
from rich.table import Column, Table

from impactlab.study.quantities import amount, time
from impactlab.variables import RESPONSES, marks, reasons, remarked
from impactlab.verification.finding import Outcome, gravest_first

if TYPE_CHECKING:
    from impactlab.study.errors import Problem
    from impactlab.study.estimate import Estimate
    from impactlab.study.runs import Status


def print_responses(run: Any) -> None:
    """The scalar responses of one run, each with its unit; a missing one as such, and why.

    run: a dataset of simulate, or one record of solver.responses.RESPONSE.
    """
    table = Table("response", "value", "unit", "meaning")
    for name, entry in RESPONSES.items():
        value = run[name].item()
        table.add_row(
            name, "missing" if value != value else f"{value:.6g}", entry.units, entry.long_name
        )
    console = Console()
    console.print(table)
    for reason in reasons(run["status"].item()):
        console.print(f"missing because {reason}; a longer duration may help", markup=False)
    for note in (*marks(run["status"].item()), *remarked(run["remarks"].item())):
        console.print(f"note: {note}", markup=False)


def print_predictions(predicted: Any) -> None:
    """One line a response: its prediction, and what the surrogate is worth on runs held out.

    predicted: a dataset of Surrogate.predict at one point.
    """
    table = Table("response", "prediction", "unit", "rms error", "Q2", "verdict")
    for name, found in predicted.data_vars.items():
        value, attrs = found.item(), found.attrs
        gap = value != value
        table.add_row(
            str(name),
            "none" if gap else f"{value:.6g}",
            attrs["units"],
            "–" if gap else f"{attrs['rmse']:.2g}",
            "–" if gap else f"{attrs['q2']:.4f}",
            attrs["verdict"].replace("_", " "),
        )
    Console().print(table)


def print_studies(rows: Iterable[tuple[str, str, str]]) -> None:
    """One line a study: name, number of runs or checks, title."""
    table = Table("study", "size", "title")
    for row in rows:
        table.add_row(*map(escape, row))
    Console().print(table)


def print_estimate(cost: Estimate, workers: int, room: float, problems: Iterable[Problem]) -> None:
    """What a study costs, a line each; and why it is not solved unless it is forced.

    room: bytes of disk that it may take.
    """
    at = ", ".join(f"{name} = {_short(value)}" for name, value in cost.largest_run.items())
    lines = {
        "runs": f"{cost.runs:,}",
        "cost": f"about {time(cost.seconds)} of one core, most of it by {cost.slow}",
        "wall": f"about {time(cost.wall(workers))} on {workers} workers",
        "memory": f"about {amount(cost.memory)}",
        "disk": f"about {amount(cost.disk)}, of {amount(room)} that it may take",
        "largest run": f"about {time(cost.largest)}" + f" ({at})" * bool(at),
    }
    if cost.auto:
        lines["discretisation"] = "auto: to be found by trials; the default stands in its place"
    console = Console(soft_wrap=True)
    for name, words in lines.items():
        console.print(f"{name:15s}{words}", markup=False, highlight=False)
    for problem in problems:
        console.print(f"beyond bearing: {problem}", markup=False, highlight=False)


def _short(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def print_outcomes(outcomes: Iterable[Outcome]) -> None:
    """One line a check: verdict, how many comparisons passed, the worst error over tolerance."""
    table = Table("check", "verdict", "passed", "worst error / tolerance", "seconds")
    for outcome in gravest_first(outcomes):
        total, worst = len(outcome.finding.comparisons), outcome.worst
        table.add_row(
            escape(outcome.name),
            outcome.verdict.upper() if outcome.verdict != "passed" else "passed",
            f"{total - len(outcome.failures)} of {total}",
            f"{worst.ratio:.2g}" if worst else "–",
            f"{outcome.seconds:.1f}",
        )
    Console().print(table)


def print_status(name: str, found: Status) -> None:
    """How far a study is: a line each for its runs, what lies on disk, and who is at work."""
    left = found.runs - found.done
    print(f"{name}: {found.done:,} of {found.runs:,} runs solved, {left:,} left")
    if found.failed:
        print(f"failed: {found.failed:,} lack a response that is asked for")
    if found.age is not None:
        print(f"on disk: {decimal(found.size)}, the latest {age_text(found.age)} ago")
    print(f"at work: {found.holder or 'nobody'}")


def print_files(reasons_of: Mapping[Path, str]) -> None:
    """One line a file that can go: its size and why; then their size in all."""
    table = Table(Column("file", overflow="fold"), "size", "why")
    for path, reason in reasons_of.items():
        table.add_row(escape(str(path)), decimal(path.stat().st_size), reason)
    Console().print(table)
    total = sum(path.stat().st_size for path in reasons_of)
    files = "1 file" if len(reasons_of) == 1 else f"{len(reasons_of)} files"
    print(f"{files}, {decimal(total)}")


def age_text(seconds: float) -> str:
    """A time span in its largest unit: 3 minutes."""
    for unit, length in (("day", 86_400), ("hour", 3600), ("minute", 60)):
        if seconds >= length:
            count = int(seconds // length)
            return f"{count} {unit}{'s' if count > 1 else ''}"
    return f"{int(seconds)} s"
