"""Tables of the convergence studies, with one row per response."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.measures import analysed
from impactlab.report.page import Cell, Row, Section, Table, largest

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
_AXES = {
    "nodes": ("Convergence in nodes along the span", _ORDERS),
    "time_step": ("Convergence in the time step at fixed nodes", _ORDERS),
    "element_size": ("Convergence in the size of the solid elements", _ORDERS),
    "points": ("Convergence in integration points over the depth", _RULES),
}
"""Caption and explanation of each axis, in the order space, time, depth."""


def convergence(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the axes that the analysis has, or none."""
    tables = []
    for axis, (caption, explanation) in _AXES.items():
        if f"{axis}_summary" not in analysis:
            continue
        columns = _columns(analysis, axis)
        rows: list[Row] = []
        for name in analysed(runs, analysis):
            found = analysis.sel(response=name)
            verdict = access.verdict(analysis, f"{axis}_summary", name)
            kind = "" if verdict and verdict.sound else "warning"
            rows.append(
                [
                    labels.sentence(labels.response(name)),
                    Cell(verdict.words if verdict else "not judged", kind),
                    _over_the_grid(found, axis),
                    *(cell(found) for cell in columns.values()),
                ]
            )
        head = ["Response", "Worst verdict", "Verdicts over the grid", *columns]
        remarks = [explanation, *_remarks(analysis, axis)]
        meanings: dict[str, str] = {}
        for kind in ("behaviour", "summary", "verdict"):
            if f"{axis}_{kind}" in analysis:
                flags = access.occurring(analysis[f"{axis}_{kind}"])
                meanings |= {flag.words: flag.meaning for flag in flags if flag.meaning}
        tables.append(Table(caption, head, rows, remarks, sorted(meanings.items())))
    return [Section("convergence", "Convergence", tables=tables)] if tables else []


def _remarks(analysis: xr.Dataset, axis: str) -> list[str]:
    """Return what is refined along with the axis, and which responses have no limit by design."""
    attrs = analysis[f"{axis}_summary"].attrs
    remarks = [str(attrs["comment"])] if attrs.get("comment") else []
    for line in attrs.get("without_limit", "").splitlines():
        name, _, reason = line.partition(": ")
        if "not convergent by design" in _behaviours(analysis.sel(response=name), axis):
            response = labels.response(name)
            remarks.append(f"The {response} is not convergent by design: {reason}.")
    return remarks


def _columns(analysis: xr.Dataset, axis: str) -> dict[str, Callable[[xr.Dataset], Cell]]:
    """Return heads, and functions from the analysis of one response to its cell."""
    if axis != "points":
        return {
            "Observed order": partial(_spread, variable=f"{axis}_observed_order"),
            "Largest GCI": partial(_gci, axis=axis),
            "Order of the fit": partial(_spread, variable=f"{axis}_fit_order"),
            "Uncertainty by the fit": partial(largest, variable=f"{axis}_fit_uncertainty"),
            "Numerical uncertainty": partial(largest, variable=f"{axis}_uncertainty"),
        }
    needed: dict[str, Callable[[xr.Dataset], Cell]] = {"Points needed for 1 %": _needed}
    if "rule" in analysis["points_needed"].dims:
        rules = labels.values(analysis["rule"], range(analysis.sizes["rule"]))
        needed = {
            f"Points needed for 1 %, {rule}": partial(_needed, rule=at)
            for at, rule in enumerate(rules)
        }
    head = "Numerical uncertainty with the most points"
    return needed | {head: partial(largest, variable="points_uncertainty")}


def _over_the_grid(found: xr.Dataset, axis: str) -> Cell:
    """Return how often each verdict occurs, and how the three finest grids behave."""
    verdicts = {}
    if f"{axis}_tally" in found:
        tally = found[f"{axis}_tally"]
        pairs = zip(tally[f"{axis}_outcome"].values, tally.values, strict=True)
        verdicts = {str(flag).replace("_", " "): int(number) for flag, number in pairs if number}
    behaviours = _behaviours(found, axis)
    detail = f"behaviour: {_listed(behaviours)}" if behaviours else ""
    return Cell(_listed(verdicts) or "–", detail=detail)


def _behaviours(found: xr.Dataset, axis: str) -> Counter[str]:
    """Count each behaviour, in words, over the rest of the grid."""
    if f"{axis}_behaviour" not in found:
        return Counter()
    flags = found[f"{axis}_behaviour"]
    return Counter(
        {flag.words: int((flags == flag.value).sum()) for flag in access.occurring(flags)}
    )


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{flag} {number}" for flag, number in counts.items())


def _spread(found: xr.Dataset, variable: str) -> Cell:
    """Return the range of the finite values over the rest of the grid."""
    values = found[variable].values if variable in found else np.array([])
    finite = values[np.isfinite(values)]
    if not finite.size:
        return Cell("–", "number")
    low, high = (labels.number(float(end), digits=3) for end in (finite.min(), finite.max()))
    return Cell(low if low == high else f"{low} to {high}", "number")


def _gci(found: xr.Dataset, axis: str) -> Cell:
    """Return the largest index, with the range of asymptotic ratios where there is one."""
    ratio = _spread(found, f"{axis}_asymptotic_ratio").text
    detail = "" if ratio == "–" else f"asymptotic ratio {ratio}"
    return Cell(largest(found, f"{axis}_gci").text, "number", detail)


def _needed(found: xr.Dataset, rule: int | None = None) -> Cell:
    """Return the range over the grid; say where not even the second most points stay within 1 %."""
    needed = found["points_needed"].isel({} if rule is None else {"rule": rule}).values
    if np.isnan(needed).all():
        return Cell("none below the largest", "warning")
    text = f"{np.nanmin(needed):.0f}"
    if np.nanmax(needed) > np.nanmin(needed):
        text += f" to {np.nanmax(needed):.0f}"
    gaps = int(np.isnan(needed).sum())
    detail = f"none below the largest at {gaps} of {needed.size} points" if gaps else ""
    return Cell(text, "number", detail)
