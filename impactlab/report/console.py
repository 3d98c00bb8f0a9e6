"""Tables that the command line prints."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.filesize import decimal
from rich.markup import escape
from rich.table import Column, Table

from impactlab.study.quantities import time
from impactlab.variables import RESPONSES, marks, reasons, warnings_in
from impactlab.verification.finding import Outcome, gravest_first

if TYPE_CHECKING:
    import xarray as xr

    from impactlab.study.errors import Problem
    from impactlab.study.estimate import Estimate
    from impactlab.study.runs import Status

_AXES = ("nodes", "points", "courant")


def print_responses(run: Any) -> None:
    """Print the scalar responses of one run with their units, and why responses are missing.

    run: a dataset of simulate, or one record of solver.outputs.RESPONSE.
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
        console.print(
            f"A response is missing because {reason}; a longer duration may help.", markup=False
        )
    for note in (*marks(run["status"].item()), *warnings_in(run["remarks"].item())):
        console.print(f"note: {note}", markup=False)


def print_predictions(predicted: Any) -> None:
    """Print one line per response: its prediction, and the surrogate's error on held-out runs.

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
    """Print one line per study: name, number of runs or checks, title."""
    table = Table("study", "size", "title")
    for row in rows:
        table.add_row(*map(escape, row))
    Console().print(table)


def print_estimate(cost: Estimate, workers: int, room: float, problems: Iterable[Problem]) -> None:
    """Print what a study costs, and the limits that it exceeds.

    room: bytes of disk that it may use.
    """
    at = ", ".join(f"{name} = {_short(value)}" for name, value in cost.largest_run.items())
    lines = {
        "runs": f"{cost.runs:,}",
        "cost": f"about {time(cost.seconds)} of one core, most of it by {cost.slow}",
        "wall": f"about {time(cost.wall(workers))} on {workers} workers",
        "memory": f"about {decimal(round(cost.memory))}",
        "disk": f"about {decimal(round(cost.disk))} of the {decimal(round(room))} that it may use",
        "largest run": f"about {time(cost.largest)}" + f" ({at})" * bool(at),
    }
    if cost.auto:
        lines["discretisation"] = (
            "auto: pilot runs will determine it; this estimate uses the default"
        )
    console = Console(soft_wrap=True)
    for name, words in lines.items():
        console.print(f"{name:15s}{words}", markup=False, highlight=False)
    for problem in problems:
        console.print(f"exceeds the limit: {problem}", markup=False, highlight=False)


def print_outcomes(outcomes: Iterable[Outcome]) -> None:
    """Print one line per check: verdict, comparisons passed, largest error over tolerance."""
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
    """Print the progress of a study: its runs, its files, and the process at work."""
    left = found.runs - found.done
    print(f"{name}: {found.done:,} of {found.runs:,} runs solved, {left:,} left")
    if found.failed:
        print(f"failed: {found.failed:,} lack a requested response")
    if found.age is not None:
        print(f"on disk: {decimal(found.size)}, last written {_age(found.age)} ago")
    print(f"at work: {found.holder or 'nobody'}")


def print_files(reasons_of: Mapping[Path, str]) -> None:
    """Print one line per file that can be removed, with size and reason; then the total size."""
    table = Table(Column("file", overflow="fold"), "size", "why")
    for path, reason in reasons_of.items():
        table.add_row(escape(str(path)), decimal(path.stat().st_size), reason)
    Console().print(table)
    total = sum(path.stat().st_size for path in reasons_of)
    files = "1 file" if len(reasons_of) == 1 else f"{len(reasons_of)} files"
    print(f"{files}, {decimal(total)}")


def print_recommendation(found: xr.Dataset) -> None:
    """Print the recommended discretisation and the evidence for it, one row per response.

    found: the dataset of study.adaptive.recommendation.
    """
    console = Console()
    best = int(found["recommended"])
    console.print(_headline(found, best), markup=False)
    table = Table(Column("response", no_wrap=True), "total", *_AXES, "checked", "")
    evidence = _evidence(found, best)
    for name in found["response"].values:
        shares = [_percent(column.sel(response=name)) for column in evidence.values()]
        remark = _remark(found.sel(response=name))
        table.add_row(str(name), *shares, *[""] * (len(table.columns) - 2 - len(shares)), remark)
    console.print(table)
    console.print(
        "The table gives the largest relative uncertainty over the "
        f"{found.sizes['case']} corner cases, in total and per axis. The check is the difference "
        "from the finest level of all axes at once.",
        markup=False,
    )


def _age(seconds: float) -> str:
    """Return a time span in its largest unit: 3 minutes."""
    for unit, length in (("day", 86_400), ("hour", 3600), ("minute", 60)):
        if seconds >= length:
            count = int(seconds // length)
            return f"{count} {unit}{'s' if count > 1 else ''}"
    return f"{int(seconds)} s"


def _short(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def _headline(found: xr.Dataset, best: int) -> str:
    tolerance = f"{100 * found.attrs['tolerance']:g} %"
    if best < 0:
        most = int(found["nodes"].max())
        return f"No discretisation up to {most} nodes meets {tolerance} for any requested response."
    chosen = found.isel(candidate=best)
    grid = ", ".join(f"{axis} = {chosen[f'candidate_{axis}'].item():g}" for axis in _AXES)
    cost = chosen["candidate_cost"].item()
    return (
        f"The cheapest discretisation for {tolerance} is {grid}; it costs {cost:.2g} times as much "
        "as the study's own."
    )


def _evidence(found: xr.Dataset, best: int) -> dict[str, xr.DataArray]:
    """Return columns on (response): the uncertainty, its parts per axis, and the check.

    best: the recommended candidate; without one (-1), the least uncertainty of all candidates.
    """
    if best < 0:
        return {"all": found["candidate_uncertainty"].min("candidate")}
    from impactlab.study.adaptive.levels import relative  # late: it loads the solver

    chosen = found.isel(candidate=best)
    last = found["nodes_value"].isel(nodes=-1, drop=True)
    parts = {
        axis: found[f"{axis}_uncertainty"].sel(
            {axis: chosen[f"candidate_{axis}"].item()}, drop=True
        )
        for axis in _AXES
    }
    parts["checked"] = found["check_difference"]
    shares = {name: relative(amount, last).max("case") for name, amount in parts.items()}
    return {"all": chosen["candidate_uncertainty"]} | shares


def _remark(found: xr.Dataset) -> str:
    if not found["asked"]:
        return "not asked"
    return "" if found["reached"] else "not reached"


def _percent(share: xr.DataArray) -> str:
    value = float(share)
    return f"{float(f'{100 * value:.2g}'):g} %" if math.isfinite(value) else "no bound"
