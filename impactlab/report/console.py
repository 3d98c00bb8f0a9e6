"""Tables that the command line prints, and why responses are missing or doubtful, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.filesize import decimal
from rich.markup import escape
from rich.table import Column, Table

from impactlab.model.parameters import PARAMETERS
from impactlab.model.quantities import engineering, time
from impactlab.variables import FAILED, FLAGS, RESPONSES, SCALARS

if TYPE_CHECKING:
    import xarray as xr

    from impactlab.study.estimate import Estimate
    from impactlab.study.inventory import Status
    from impactlab.verification.finding import Outcome
from collections.abc import Iterator

from impactlab.variables import FAILURES, MARKS, WARNINGS

_AXES = ("nodes", "points", "courant")


def print_responses(run: Any) -> None:
    """Print the scalar responses of one run with their units, and why responses are missing.

    run: a dataset of `simulate`, or what `solve` returns of one run.
    """
    rows = []
    for name, entry in RESPONSES.items():
        value = run[name].item()
        text = "missing" if math.isnan(value) else engineering(value, entry.units)
        if "plastic_strain" in name and not math.isnan(value):
            text = f"{float(f'{100 * value:.4g}'):,g} %"
        rows.append((name, text, entry.long_name))
    _print_table(("response", Column("value", justify="right"), "meaning"), rows)
    for sentence in sentences(run):
        Console().print(sentence, markup=False)


def print_predictions(predicted: Any) -> None:
    """Print one line per response: its prediction, and the half-width of its interval.

    predicted: a dataset of Surrogate.predict at one point.
    """
    rows = []
    for name, prediction in predicted.data_vars.items():
        value, attrs = prediction.item(), prediction.attrs
        numbers, verdict = ("none", "–", "–"), attrs["verdict"].replace("_", " ")
        if not math.isnan(value):
            error = engineering(attrs["error"], attrs["units"], digits=2)
            numbers = (engineering(value, attrs["units"]), error, f"{attrs['q2']:.4f}")
        if verdict == "imprecise":
            share = attrs["error"] / abs(value) if value else math.inf
            percent = f"the error is {100 * share:.0f} % of the prediction"
            verdict += f": {'zero lies within the error' if share > 1 else percent}"
        if verdict == "extrapolated":
            verdict += ": farther out than any run tested on"
        rows.append((str(name), *numbers, verdict))
    _print_table(("response", "prediction", "± 95 %", "Q2", "verdict"), rows)


def print_studies(rows: Iterable[tuple[str, str, str]]) -> None:
    """Print one line per study: name, number of runs or checks, title."""
    _print_table(("study", "size", "title"), [map(escape, row) for row in rows])


def print_solved(path: Path) -> None:
    """Print one line about solved runs: their file and number, and the range of a response."""
    from impactlab.files import opened, row_blocks  # late: it loads xarray

    with opened(path, indexed=False) as runs:
        blocks = row_blocks(runs["status"].variable) if "status" in runs else ()
        failed = sum(int(np.count_nonzero(block & FAILED)) for block in blocks)
        name = next(name for name in runs.data_vars if name not in FLAGS)
        ends = [
            (np.fmin.reduce(block, None), np.fmax.reduce(block, None))
            for block in row_blocks(runs[name].variable)
        ]
        low, high = float(np.fmin.reduce(ends)[0]), float(np.fmax.reduce(ends)[1])
        size, units = runs[name].size, str(runs[name].attrs["units"])
    text = f"{path}: {size:,} run{'' if size == 1 else 's'}, {failed:,} without an answer"
    if not math.isnan(low):
        text += f"; {name} from {engineering(low, units)} to {engineering(high, units)}"
    print(text)


def print_estimate(cost: Estimate, workers: int) -> None:
    """Print what a study costs, and the limits that it exceeds."""
    settings = []
    for name, value in cost.largest_run.items():
        units = PARAMETERS[name].units if name in PARAMETERS else "1"
        settings.append(
            f"{name} = {value if isinstance(value, str) else engineering(value, units)}"
        )
    case = f" ({', '.join(settings)})" if settings else ""
    lines = {
        "runs": f"{cost.runs:,}",
        "cost": f"about {time(cost.wall(1))} of one core, most of it by {cost.slow}",
        "wall": f"about {time(cost.wall(workers))} on {workers} workers",
        "memory": f"about {decimal(round(cost.memory))}",
        "disk": f"about {decimal(round(cost.disk))} of the "
        f"{decimal(round(cost.free))} that it may use",
        "largest run": f"about {time(cost.largest)}{case}",
    }
    if cost.auto:
        default = "auto: pilot runs will determine it; this estimate uses the default"
        lines["discretisation"] = default
    console = Console(soft_wrap=True)
    for name, text in lines.items():
        console.print(f"{name:15s}{text}", markup=False, highlight=False)
    for problem in cost.exceeded():
        console.print(f"exceeds the limit: {problem}", markup=False, highlight=False)


def print_outcomes(outcomes: Iterable[Outcome]) -> None:
    """Print one line per check: verdict, comparisons passed, largest error over tolerance."""
    from impactlab.verification.finding import gravest_first  # late: it loads xarray

    rows = []
    for outcome in gravest_first(outcomes):
        total, worst = len(outcome.finding.comparisons), outcome.worst
        passed = f"{total - len(outcome.failures)} of {total}"
        verdict = outcome.verdict if outcome.verdict == "passed" else outcome.verdict.upper()
        ratio = f"{worst.ratio:.2g}" if worst else "–"
        rows.append((escape(outcome.name), verdict, passed, ratio, f"{outcome.seconds:.1f}"))
    _print_table(("check", "verdict", "passed", "worst error / tolerance", "seconds"), rows)


def print_status(name: str, status: Status) -> None:
    """Print the progress of a study: its runs, its files, and the process at work."""
    left = status.runs - status.done
    print(f"{name}: {status.done:,} of {status.runs:,} runs solved, {left:,} left")
    if status.failed:
        print(f"failed: {status.failed:,} lack a requested response")
    if status.age is not None:
        print(f"on disk: {decimal(status.size)}, last written {time(status.age)} ago")
    print(f"at work: {status.holder or 'nobody'}")
    print(status.written)


def print_files(reasons_of: Mapping[Path, str]) -> None:
    """Print one line per file that can be removed, with size and reason; then the total size."""
    sizes = {path: path.stat().st_size for path in reasons_of}
    rows = [(escape(str(path)), decimal(sizes[path]), why) for path, why in reasons_of.items()]
    _print_table((Column("file", overflow="fold"), "size", "why"), rows)
    files = "1 file" if len(sizes) == 1 else f"{len(sizes)} files"
    print(f"{files}, {decimal(sum(sizes.values()))}")


def print_recommendation(candidates: xr.Dataset) -> None:
    """Print the recommended discretisation and the evidence for it, one row per response.

    candidates: the dataset of study.adaptive.recommendation.
    """
    best, tolerance = int(candidates["recommended"]), f"{100 * candidates.attrs['tolerance']:g} %"
    none = f"No discretisation up to {int(candidates['nodes'].max())} nodes meets {tolerance} for"
    missed = candidates["response"].values[(candidates["asked"] & ~candidates["reached"]).values]
    if best < 0:
        head = f"{none} any requested response."
    else:
        chosen = candidates.isel(candidate=best)
        grid = ", ".join(f"{axis} = {chosen[f'candidate_{axis}'].item():g}" for axis in _AXES)
        head = (
            f"The cheapest discretisation for {tolerance} is {grid}; it costs "
            f"{chosen['candidate_cost'].item():.2g} times as much as the study's own."
        )
        if missed.size:
            head = f"{none} {', '.join(missed)}. Without them: t{head[1:]}"
    console = Console()
    console.print(head, markup=False)
    evidence = _evidence(candidates, best)
    rows = []
    for name in candidates["response"].values:
        shares = [float(column.sel(response=name)) for column in evidence]
        texts = [
            f"{float(f'{100 * share:.2g}'):g} %" if math.isfinite(share) else "no bound"
            for share in shares
        ]
        row = candidates.sel(response=name)
        remark = ("" if row["reached"] else "not reached") if row["asked"] else "not asked"
        rows.append((str(name), *texts, *[""] * (len(_AXES) + 2 - len(texts)), remark))
    _print_table((Column("response", no_wrap=True), "total", *_AXES, "checked", ""), rows)
    console.print(
        "The table gives the largest relative uncertainty over the "
        f"{candidates.sizes['case']} corner cases, in total and per axis. The check is the "
        "difference from the finest level of all axes at once.",
        markup=False,
    )


def _evidence(candidates: xr.Dataset, best: int) -> list[xr.DataArray]:
    """Return columns on (response): the uncertainty, its parts per axis, and the check.

    best: the recommended candidate; without one (-1), the least uncertainty of all candidates.
    """
    if best < 0:
        return [candidates["candidate_uncertainty"].min("candidate")]
    from impactlab.study.adaptive.recommendation import relative  # late: it loads the solver

    chosen = candidates.isel(candidate=best)
    last = candidates["nodes_value"].isel(nodes=-1, drop=True)
    parts = [
        candidates[f"{axis}_uncertainty"].sel({axis: chosen[f"candidate_{axis}"].item()}, drop=True)
        for axis in _AXES
    ]
    shares = [relative(part, last).max("case") for part in (*parts, candidates["check_difference"])]
    return [chosen["candidate_uncertainty"], *shares]


def _print_table(head: Iterable[str | Column], rows: Iterable[Iterable[str]]) -> None:
    table = Table(*head)
    for row in rows:
        table.add_row(*row)
    Console().print(table)


def explain(runs: Any) -> list[str]:
    """Say in words why responses are missing or doubtful.

    Parameters
    ----------
    runs : xarray.Dataset
        One run of `simulate`, or many: of `simulate_many`, `Study.run` or a file `runs.nc`.

    Returns
    -------
    list of str
        A sentence for each reason that `status` names, then for each warning in `remarks`; of many
        runs with their number. Empty where nothing is missing or doubtful.

    Raises
    ------
    ValueError
        If `runs` has no `status`.

    Examples
    --------
    >>> soft = il.paper_impact("5 m/s", "finite_element")
    >>> run = il.simulate(soft, il.Discretisation(nodes=41), duration="12 ms")
    >>> il.explain(run)
    []
    """
    if "status" not in runs:
        raise ValueError(
            "explain: the dataset has no `status`: take the runs of simulate, simulate_many or "
            "Study.run, not an analysis of them (for which il.answers has sentences)"
        )
    return list(sentences(runs))


def sentences(runs: Any) -> Iterator[str]:
    """Yield what `explain` returns; runs may also be what solver.solve returns."""
    status = np.asarray(runs["status"])
    remarks = np.asarray(runs["remarks"]) if "remarks" in runs else np.zeros(1, int)
    for flag, (bit, reason) in FAILURES.items():
        if number := int(((status & bit) != 0).sum()):
            names = [name for name, entry in SCALARS.items() if entry.missing == flag]
            names = [name for name in names if name in runs]
            missing = f"missing because {reason}: {', '.join(names)}"
            yield _sentence(number, status.size, missing if names else reason)
    for bits, flags in ((status, MARKS), (remarks, WARNINGS)):
        for bit, text in flags.values():
            if number := int(((bits & bit) != 0).sum()):
                yield _sentence(number, status.size, text)


def _sentence(number: int, runs: int, text: str) -> str:
    """Return a sentence on one run, or on a number of runs."""
    return f"{number:,} of {runs:,} runs: {text}." if runs > 1 else f"{text[0].upper()}{text[1:]}."
