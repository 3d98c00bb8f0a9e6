"""The verdicts of the convergence studies, a row a response."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import known, responses
from impactlab.report.table import Cell, Table


@dataclass(frozen=True)
class Judged:
    """One axis: its table, what to know of it, verdicts and behaviours with their meanings."""

    table: Table
    remarks: list[str]
    meanings: list[tuple[str, str]]


def judged(runs: xr.Dataset, analysis: xr.Dataset) -> list[Judged]:
    """The axes that the analysis has, in the order space, time, depth."""
    return [
        Judged(
            table(runs, analysis, axis, caption),
            [reading, *remarks(analysis, axis)],
            meanings(analysis, axis),
        )
        for axis, (caption, table, reading) in _AXES.items()
        if f"{axis}_summary" in analysis
    ]


def meanings(analysis: xr.Dataset, axis: str) -> list[tuple[str, str]]:
    """Each behaviour and verdict that occurs, in words, with what it means."""
    found: dict[str, str] = {}
    for kind in ("behaviour", "summary", "verdict"):
        if f"{axis}_{kind}" in analysis:
            flags = access.occurring(analysis[f"{axis}_{kind}"])
            found |= {flag.words: flag.meaning for flag in flags if flag.meaning}
    return sorted(found.items())


def remarks(analysis: xr.Dataset, axis: str) -> list[str]:
    """What is refined along with the axis, and what has no limit by design."""
    summary = analysis[f"{axis}_summary"]
    without = [line.partition(": ") for line in summary.attrs.get("without_limit", "").splitlines()]
    reasons = [
        f"The {labels.response(name)} is not convergent by design: {reason}."
        for name, _, reason in without
        if _counts(analysis, f"{axis}_behaviour", name).get("not convergent by design")
    ]
    return [*filter(None, [str(summary.attrs.get("comment", ""))]), *reasons]


def _refined(runs: xr.Dataset, analysis: xr.Dataset, axis: str, caption: str) -> Table:
    """An axis that has an order: nodes, time step."""
    head = [
        "Response",
        "Worst verdict",
        "Verdicts over the grid",
        "Observed order",
        "Largest GCI",
        "Order of the fit",
        "Uncertainty by the fit",
        "Numerical uncertainty",
    ]
    rows = [
        [
            *_verdicts(analysis, axis, name),
            Cell(_spread(analysis, f"{axis}_observed_order", name), "number"),
            _gci(analysis, axis, name),
            Cell(_spread(analysis, f"{axis}_fit_order", name), "number"),
            Cell(_percent(_largest(analysis, f"{axis}_fit_uncertainty", name)), "number"),
            Cell(_percent(_largest(analysis, f"{axis}_uncertainty", name)), "number"),
        ]
        for name in responses(runs)
        if known(analysis, name)
    ]
    return Table(caption, head, rows)


def _points(runs: xr.Dataset, analysis: xr.Dataset, axis: str, caption: str) -> Table:
    """Integration points: how many are needed, by each rule."""
    rules = _rules(analysis)
    head = ["Response", "Worst verdict", "Verdicts over the grid"]
    head += [f"Points needed for 1 %{f', {rule}' if rule else ''}" for rule in rules]
    rows = [
        [
            *_verdicts(analysis, axis, name),
            *(_needed(analysis, name, where) for where in rules.values()),
            Cell(_percent(_largest(analysis, "points_uncertainty", name)), "number"),
        ]
        for name in responses(runs)
        if known(analysis, name)
    ]
    return Table(caption, [*head, "Numerical uncertainty with the most points"], rows)


def _rules(analysis: xr.Dataset) -> dict[str, dict[str, int]]:
    """Each integration rule in words, with where it is; all at once where none is varied."""
    if "points_needed" not in analysis or "rule" not in analysis["points_needed"].dims:
        return {"": {}}
    names = labels.values(analysis["rule"], range(analysis.sizes["rule"]))
    return {name: {"rule": at} for at, name in enumerate(names)}


_Table = Callable[[xr.Dataset, xr.Dataset, str, str], Table]
_ORDERS = (
    "Observed order, grid convergence index (GCI) and asymptotic ratio are those of the three "
    "finest grids, with the factor 1.25, or 3 where not every three successive grids show a "
    "credible order. The fit is that of Eça and Hoekstra over four grids or more. The numerical "
    "uncertainty of the finest value rests on both, on the larger where there is an order; all are "
    "relative to that value. Ranges and largest values are over the rest of the grid."
)
_RULES = (
    "Each rule is judged by its own most points. The numerical uncertainty is three times the "
    "difference to the next fewer points, since the error need not follow a power of the points."
)
_AXES: dict[str, tuple[str, _Table, str]] = {
    "nodes": ("Convergence in nodes along the span", _refined, _ORDERS),
    "time_step": ("Convergence in the time step at fixed nodes", _refined, _ORDERS),
    "element_size": ("Convergence in the size of the solid elements", _refined, _ORDERS),
    "points": ("Convergence in integration points over the depth", _points, _RULES),
}
"""Caption and table of each axis, and how to read it."""


def _verdicts(analysis: xr.Dataset, axis: str, name: str) -> list[Cell]:
    verdict = access.verdict(analysis, f"{axis}_summary", name)
    text = verdict.words if verdict else "not judged"
    kind = "" if verdict and verdict.sound else "warning"
    return [
        Cell(labels.sentence(labels.response(name))),
        Cell(text, kind),
        Cell(_tally(analysis, axis, name), detail=_behaviours(analysis, axis, name)),
    ]


def _tally(analysis: xr.Dataset, axis: str, name: str) -> str:
    """How often each verdict occurs over the rest of the grid: "converged 22, divergent 2"."""
    if f"{axis}_tally" not in analysis:
        return "–"
    tally = analysis[f"{axis}_tally"].sel(response=name)
    outcomes = tally[f"{axis}_outcome"].values
    pairs = zip(outcomes, tally.values, strict=True)
    return _listed({str(flag).replace("_", " "): int(n) for flag, n in pairs if n})


def _behaviours(analysis: xr.Dataset, axis: str, name: str) -> str:
    """How the three finest grids behave, where an axis has an order; "" else."""
    counts = _counts(analysis, f"{axis}_behaviour", name)
    return f"behaviour: {_listed(counts)}" if counts else ""


def _gci(analysis: xr.Dataset, axis: str, name: str) -> Cell:
    """The largest index, and the asymptotic ratio of all where there is one."""
    ratio = _spread(analysis, f"{axis}_asymptotic_ratio", name)
    detail = "" if ratio == "–" else f"asymptotic ratio {ratio}"
    return Cell(_percent(_largest(analysis, f"{axis}_gci", name)), "number", detail)


def _counts(analysis: xr.Dataset, variable: str, name: str) -> dict[str, int]:
    """How often each flag occurs over the rest of the grid, in words."""
    if variable not in analysis:
        return {}
    flags = analysis[variable].sel(response=name)
    found = access.occurring(flags)
    return {flag.words: int((flags == flag.value).sum()) for flag in found}


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{flag} {number}" for flag, number in counts.items()) or "–"


def _needed(analysis: xr.Dataset, name: str, where: dict[str, int]) -> Cell:
    """The range over the grid; says where not even the second most points stay within 1 %."""
    if "points_needed" not in analysis:
        return Cell("–", "number")
    needed = analysis["points_needed"].sel(response=name).isel(where).values
    if np.isnan(needed).all():
        return Cell("none below the most", "warning")
    text = f"{np.nanmin(needed):.0f}"
    if np.nanmax(needed) > np.nanmin(needed):
        text += f" to {np.nanmax(needed):.0f}"
    gaps = int(np.isnan(needed).sum())
    return Cell(
        text, "number", f"none below the most at {gaps} of {needed.size} points" if gaps else ""
    )


def _finite(analysis: xr.Dataset, variable: str, name: str) -> np.ndarray:
    if variable not in analysis:
        return np.array([])
    values = analysis[variable].sel(response=name).values
    return np.asarray(values[np.isfinite(values)], dtype=float)


def _spread(analysis: xr.Dataset, variable: str, name: str) -> str:
    values = _finite(analysis, variable, name)
    if not values.size:
        return "–"
    low, high = (labels.number(float(end), digits=3) for end in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def _largest(analysis: xr.Dataset, variable: str, name: str) -> float:
    """The largest value; infinite where one is, NaN where none is."""
    if variable not in analysis:
        return float("nan")
    values = np.ravel(analysis[variable].sel(response=name).values)
    values = values[~np.isnan(values)]
    return float(values.max()) if values.size else float("nan")


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{labels.number(100 * share, digits=2)} %"
