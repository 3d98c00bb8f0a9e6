"""Tables of the convergence studies, with one row per response."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import known, responses
from impactlab.report.page import Cell, Table


@dataclass(frozen=True)
class Refinement:
    """One refined axis.

    table: one row per response. remarks: how to read it. meanings: verdicts and behaviours that
    occur, each with its meaning.
    """

    table: Table
    remarks: list[str]
    meanings: list[tuple[str, str]]


def convergence(runs: xr.Dataset, analysis: xr.Dataset) -> list[Refinement]:
    """Return the axes that the analysis has, in the order space, time, depth."""
    return [
        Refinement(
            table(runs, analysis, axis, caption),
            [reading, *_remarks(analysis, axis)],
            _meanings(analysis, axis),
        )
        for axis, (caption, table, reading) in _AXES.items()
        if f"{axis}_summary" in analysis
    ]


def _meanings(analysis: xr.Dataset, axis: str) -> list[tuple[str, str]]:
    """Return each behaviour and verdict that occurs, in words, with its meaning."""
    found: dict[str, str] = {}
    for kind in ("behaviour", "summary", "verdict"):
        if f"{axis}_{kind}" in analysis:
            flags = access.occurring(analysis[f"{axis}_{kind}"])
            found |= {flag.words: flag.meaning for flag in flags if flag.meaning}
    return sorted(found.items())


def _remarks(analysis: xr.Dataset, axis: str) -> list[str]:
    """Return what is refined along with the axis, and which responses have no limit by design."""
    summary = analysis[f"{axis}_summary"]
    without = [line.partition(": ") for line in summary.attrs.get("without_limit", "").splitlines()]
    reasons = [
        f"The {labels.response(name)} is not convergent by design: {reason}."
        for name, _, reason in without
        if _counts(analysis, f"{axis}_behaviour", name).get("not convergent by design")
    ]
    return [*filter(None, [str(summary.attrs.get("comment", ""))]), *reasons]


def _refined(runs: xr.Dataset, analysis: xr.Dataset, axis: str, caption: str) -> Table:
    """Return the table of an axis with an order of convergence: nodes, time step."""
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
    """Return the table of integration points: how many each rule needs."""
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
    """Return the index of each integration rule; {"": {}} where the rule is not varied."""
    if "points_needed" not in analysis or "rule" not in analysis["points_needed"].dims:
        return {"": {}}
    names = labels.values(analysis["rule"], range(analysis.sizes["rule"]))
    return {name: {"rule": at} for at, name in enumerate(names)}


_ORDERS = (
    "The observed order, the grid convergence index (GCI) and the asymptotic ratio come from the "
    "three finest grids, with the factor 1.25, or 3 where not every three successive grids show a "
    "credible order. The fit is that of Eça and Hoekstra over four grids or more. The numerical "
    "uncertainty of the finest value is based on both, and on the larger where there is an order; "
    "all are relative to that value. Ranges and largest values are taken over the rest of the grid."
)
_RULES = (
    "Each rule is compared with its own largest number of points. The numerical uncertainty is "
    "three times the difference from the next smaller number, because the error need not follow a "
    "power of the number of points."
)
_AXES: dict[str, tuple[str, Callable[[xr.Dataset, xr.Dataset, str, str], Table], str]] = {
    "nodes": ("Convergence in nodes along the span", _refined, _ORDERS),
    "time_step": ("Convergence in the time step at fixed nodes", _refined, _ORDERS),
    "element_size": ("Convergence in the size of the solid elements", _refined, _ORDERS),
    "points": ("Convergence in integration points over the depth", _points, _RULES),
}
"""Caption, table and explanation of each axis."""


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
    """Count each verdict over the rest of the grid: "converged 22, divergent 2"."""
    if f"{axis}_tally" not in analysis:
        return "–"
    tally = analysis[f"{axis}_tally"].sel(response=name)
    outcomes = tally[f"{axis}_outcome"].values
    pairs = zip(outcomes, tally.values, strict=True)
    return _listed({str(flag).replace("_", " "): int(n) for flag, n in pairs if n})


def _behaviours(analysis: xr.Dataset, axis: str, name: str) -> str:
    """Return how the three finest grids behave; "" for an axis without an order."""
    counts = _counts(analysis, f"{axis}_behaviour", name)
    return f"behaviour: {_listed(counts)}" if counts else ""


def _gci(analysis: xr.Dataset, axis: str, name: str) -> Cell:
    """Return the largest index, with the range of asymptotic ratios where there is one."""
    ratio = _spread(analysis, f"{axis}_asymptotic_ratio", name)
    detail = "" if ratio == "–" else f"asymptotic ratio {ratio}"
    return Cell(_percent(_largest(analysis, f"{axis}_gci", name)), "number", detail)


def _counts(analysis: xr.Dataset, variable: str, name: str) -> dict[str, int]:
    """Count each flag, in words, over the rest of the grid."""
    if variable not in analysis:
        return {}
    flags = analysis[variable].sel(response=name)
    found = access.occurring(flags)
    return {flag.words: int((flags == flag.value).sum()) for flag in found}


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{flag} {number}" for flag, number in counts.items()) or "–"


def _needed(analysis: xr.Dataset, name: str, where: dict[str, int]) -> Cell:
    """Return the range over the grid; say where not even the second most points stay within 1 %."""
    if "points_needed" not in analysis:
        return Cell("–", "number")
    needed = analysis["points_needed"].sel(response=name).isel(where).values
    if np.isnan(needed).all():
        return Cell("none below the largest", "warning")
    text = f"{np.nanmin(needed):.0f}"
    if np.nanmax(needed) > np.nanmin(needed):
        text += f" to {np.nanmax(needed):.0f}"
    gaps = int(np.isnan(needed).sum())
    return Cell(
        text, "number", f"none below the largest at {gaps} of {needed.size} points" if gaps else ""
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
    """Return the largest value; infinite where one is, NaN where there is none."""
    if variable not in analysis:
        return float("nan")
    values = np.ravel(analysis[variable].sel(response=name).values)
    values = values[~np.isnan(values)]
    return float(values.max()) if values.size else float("nan")


def _percent(share: float) -> str:
    return "–" if np.isnan(share) else f"{labels.number(100 * share, digits=2)} %"
