"""What a convergence study found: the grid each response needs, and tables per axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.analysis.verdicts import TOLERANCE
from impactlab.figures import access, labels
from impactlab.figures.measures import analysed
from impactlab.figures.needs import Needs, at_finest, needed
from impactlab.report.page import Cell, Row, Section, Table, largest
from impactlab.types import Floats

_ORDERS = (
    "The observed order, the grid convergence index (GCI) and the asymptotic ratio come from the "
    "three finest grids, with the factor 1.25, or 3 where not every three successive grids show a "
    "credible order, or it is above 2.1. The fit is that of Eça and Hoekstra over four grids or "
    "more. The numerical uncertainty of the finest value is based on both, and on the larger where "
    "there is an order; on the range of the values where the grids span less than a factor of 2; "
    "all are relative to that value. Ranges and largest values are taken over the rest of the grid."
)
_WITHIN = (
    "The error is the difference to the finest grid plus the uncertainty of that grid, the largest "
    "over the rest of the study; it stays within the tolerance on every finer grid as well. The "
    "verdicts are those of the finest grid."
)
_RULES = (
    "Each rule is compared with its own largest number of points. The numerical uncertainty is "
    "three times the difference from the next smaller number, because the error need not follow a "
    "power of the number of points."
)
_AXES = {
    "nodes": ("Convergence in nodes along the span", _ORDERS),
    "time_step": ("Convergence in the time step at fixed nodes", _ORDERS),
    **{model.axis: (model.axis_title, _ORDERS) for model in wings.models().values()},
    "points": ("Convergence in integration points over the depth", _RULES),
}
"""Caption and explanation of each axis, in the order space, time, depth."""


def convergence(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the axes that the analysis has, or none."""
    needs, tables = needed(runs, analysis), []
    if needs:
        tables.append(_needs(analysis, needs))
    for axis, (caption, explanation) in _AXES.items():
        if f"{axis}_summary" not in analysis:
            continue
        cells: dict[str, Cell] = {}
        rows: list[Row] = []
        for name in analysed(runs, analysis):
            found = analysis.sel(response=name)
            verdict = at_finest(found, needs.runs if needs else runs, axis)
            kind = "" if verdict and verdict.sound else "warning"
            judged = Cell(verdict.words if verdict else "not judged", kind)
            over = (_counts(found, f"{axis}_{kind}") for kind in ("verdict", "behaviour"))
            verdicts, behaviours = (", ".join(map(" ".join, each.items())) for each in over)
            detail = f"behaviour: {behaviours}" * bool(behaviours)
            cells = _cells(found, axis)
            response = labels.sentence(labels.response(name))
            rows.append([response, judged, Cell(verdicts or "–", detail=detail), *cells.values()])
        head = ["Response", "Verdict on the finest grid", "Verdicts over the grid", *cells]
        remarks = [explanation, *_remarks(analysis, axis)]
        meanings: dict[str, str] = {}
        for kind in ("behaviour", "summary", "verdict"):
            flags = access.occurring(analysis.get(f"{axis}_{kind}", xr.DataArray()))
            meanings |= {flag.words: flag.meaning for flag in flags if flag.meaning}
        tables.append(Table(caption, head, rows, remarks, sorted(meanings.items())))
    return [Section("convergence", "Convergence", tables=tables)] if tables else []


def _needs(analysis: xr.Dataset, needs: Needs) -> Table:
    """Return one row per response: the grid from which it is within tolerance."""
    rows: list[Row] = []
    for name, errors in needs.errors.items():
        need, best = needs.grids.get(name), float(errors.min())
        grid: list[Cell | str] = [Cell("none of this study", "warning"), "–"]
        if need:
            grid = [needs.words(need), Cell(labels.percent(float(errors[need])), "number")]
        least = Cell(labels.percent(best) if best < 1 else "no bound", "number")
        doubts = ", ".join(needs.doubts(analysis, name)) or "–"
        rows.append([labels.sentence(labels.response(name)), *grid, least, doubts])
    share = labels.percent(TOLERANCE)
    head = ["Response", f"Within {share} from", "Error there", "Least error", "Doubts"]
    return Table(f"Grid that keeps each response within {share}", head, rows, [_WITHIN])


def _remarks(analysis: xr.Dataset, axis: str) -> list[str]:
    """Return what is refined along with the axis, and which responses have no limit by design."""
    attrs = analysis[f"{axis}_summary"].attrs
    remarks = [str(attrs["comment"])] if attrs.get("comment") else []
    for line in attrs.get("without_limit", "").splitlines():
        name, _, reason = line.partition(": ")
        if "not convergent by design" in _counts(analysis.sel(response=name), f"{axis}_behaviour"):
            remarks.append(f"The {labels.response(name)} is not convergent by design: {reason}.")
    return remarks


def _cells(found: xr.Dataset, axis: str) -> dict[str, Cell]:
    """Return the numbers of one response, by the head of their column."""
    uncertainty = largest(found, f"{axis}_uncertainty")
    if axis != "points":
        ratio = _spread(found, f"{axis}_asymptotic_ratio").text
        detail = "" if ratio == "–" else f"asymptotic ratio {ratio}"
        return {
            "Observed order": _spread(found, f"{axis}_observed_order"),
            "Largest GCI": replace(largest(found, f"{axis}_gci"), detail=detail),
            "Order of the fit": _spread(found, f"{axis}_fit_order"),
            "Uncertainty by the fit": largest(found, f"{axis}_fit_uncertainty"),
            "Numerical uncertainty": uncertainty,
        }
    head, needed = "Points needed for 1 %", found["points_needed"]
    cells = {head: needed}
    if "rule" in needed.dims:
        rules = labels.values(needed["rule"], range(needed.sizes["rule"]))
        cells = {f"{head}, {rule}": needed.isel(rule=at) for at, rule in enumerate(rules)}
    uncertain = {"Numerical uncertainty with the most points": uncertainty}
    return {head: _needed(each.values) for head, each in cells.items()} | uncertain


def _counts(found: xr.Dataset, variable: str) -> dict[str, str]:
    """Count each flag, in words, over the rest of the grid."""
    flags = found.get(variable, xr.DataArray())
    return {flag.words: str(int((flags == flag.value).sum())) for flag in access.occurring(flags)}


def _spread(found: xr.Dataset, variable: str) -> Cell:
    values = found.get(variable, xr.DataArray()).values
    finite = values[np.isfinite(values)]
    return Cell(labels.span(finite, 3) if finite.size else "–", "number")


def _needed(needed: Floats) -> Cell:
    """Return the range over the grid; say where not even the second most points stay within 1 %."""
    given, none = needed[np.isfinite(needed)], "none below the largest"
    if not given.size:
        return Cell(none, "warning")
    gaps = needed.size - given.size
    detail = f"{none} at {gaps} of {needed.size} points" * bool(gaps)
    return Cell(labels.span(given, 4), "number", detail)
