"""Sections on convergence: the grid that each response needs, and tables per axis."""

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.figures import access, labels
from impactlab.figures.needs import Needs, finest, needed
from impactlab.report.page import Cell, Row, Section, Table, largest
from impactlab.types import Floats
from impactlab.verdicts import TOLERANCE

_ORDERS = (
    "The observed order, the grid convergence index (GCI) and the asymptotic ratio come from the "
    "three finest grids, with the factor 1.25, or 3 where not every three successive grids show a "
    "credible order, or it is above 2.1. The fit is that of Eça and Hoekstra over four grids or "
    "more. The numerical uncertainty of the finest value is based on both, and on the larger where "
    "there is an order; it is at least three times the error of first order unless the next three "
    "grids, or where there are none the scheme, confirm that order; where the grids span less than "
    "a factor of 2 it is based on the range of the values; all are relative to that value. The "
    "index and the fit stand only where the uncertainty rests on them. Other axes are at their "
    "finest values; ranges and largest values are over the rest of the study."
)
_WITHIN = (
    "The error is the difference to the finest grid plus the uncertainty of that grid, the largest "
    "over the rest of the study; it stays within the tolerance on every finer grid as well. Doubts "
    "are the verdicts of the finest grid, which the tables below explain."
)
_RULES = (
    "Each rule is compared with its own largest number of points. The numerical uncertainty is "
    "three times the difference from the next smaller number, because the error need not follow a "
    "power of the number of points; the points needed keep error and uncertainty together within "
    "1 %. The nodes and the time step are at their finest values; the largest values are over the "
    "rest of the study."
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
    needs = needed(runs, analysis)
    if needs is None:
        return []
    tables = [_needs(needs)]
    for axis, (caption, explanation) in _AXES.items():
        if f"{axis}_verdict" not in needs.analysis:
            continue
        cells: dict[str, Cell] = {}
        rows: list[Row] = []
        for name in needs.errors:
            numbers = needs.analysis.sel(response=name)
            behaviours = access.occurring(numbers.get(f"{axis}_behaviour", xr.DataArray()))
            detail = ", ".join(behaviour.words for behaviour in behaviours)
            detail = f"behaviour: {detail}" if detail else ""
            verdict = needs.verdict(axis, name)
            kind = "" if verdict and verdict.sound else "warning"
            judged = Cell(verdict.words if verdict else "not judged", kind, detail)
            cells = (
                _cells(numbers, axis) if axis != "points" else _points_cells(analysis, needs, name)
            )
            rows.append([labels.title(name), judged, *cells.values()])
        remarks = [explanation, *_remarks(needs.analysis, axis)]
        meanings: dict[str, str] = {}
        for key in ("behaviour", "verdict"):
            flags = access.occurring(needs.analysis.get(f"{axis}_{key}", xr.DataArray()))
            meanings |= {flag.words: flag.meaning for flag in flags if flag.meaning}
        beside = needs.beside(axis)
        title = f"{caption}: {beside}" if beside else caption
        head = ["Response", "Verdict", *cells]
        tables.append(Table(title, head, rows, remarks, sorted(meanings.items())))
    return [Section("convergence", "Convergence", tables=tables)]


def _needs(needs: Needs) -> Table:
    """Return one row per response: the grid from which it is within tolerance."""
    rows: list[Row] = []
    for name, errors in needs.errors.items():
        need = needs.grids.get(name)
        grid: list[Cell | str] = [Cell("none of this study", "warning"), "–"]
        if need:
            grid = [needs.words(need), Cell(labels.percent(float(errors[need])), "number")]
        least = Cell(labels.percent(float(errors.min())), "number")
        doubts = ", ".join(needs.doubts(name)) or "–"
        rows.append([labels.title(name), *grid, least, doubts])
    share = labels.percent(TOLERANCE)
    head = ["Response", f"Within {share} from", "Error there", "Least error", "Doubts"]
    return Table(f"Grid that keeps each response within {share}", head, rows, [_WITHIN])


def _remarks(analysis: xr.Dataset, axis: str) -> list[str]:
    """Return what is refined along with the axis, and which responses have no limit by design."""
    attrs = analysis[f"{axis}_verdict"].attrs
    remarks = [str(attrs["comment"])] if attrs.get("comment") else []
    for line in attrs.get("without_limit", "").splitlines():
        name, _, reason = line.partition(": ")
        behaviours = access.occurring(analysis[f"{axis}_behaviour"].sel(response=name))
        if any(behaviour.flag == "not_convergent_by_design" for behaviour in behaviours):
            remarks.append(f"The {labels.response(name)} is not convergent by design: {reason}.")
    return remarks


def _cells(numbers: xr.Dataset, axis: str) -> dict[str, Cell]:
    """Return the numbers of one response at the finest grid, by the head of their column."""
    indexed = _resting_on(numbers, axis, "gci", "gci_and_fit")
    fitted = _resting_on(numbers, axis, "fit", "gci_and_fit")
    ratio = _spread(indexed, f"{axis}_asymptotic_ratio").text
    detail = "" if ratio == "–" else f"asymptotic ratio {ratio}"
    return {
        "Observed order": _spread(numbers, f"{axis}_observed_order"),
        "Largest GCI": replace(largest(indexed, f"{axis}_gci"), detail=detail),
        "Order of the fit": _spread(fitted, f"{axis}_fit_order"),
        "Uncertainty by the fit": largest(fitted, f"{axis}_fit_uncertainty"),
        "Numerical uncertainty": _uncertainty(numbers, axis),
    }


def _resting_on(numbers: xr.Dataset, axis: str, *flags: str) -> xr.Dataset:
    """Return the numbers where the uncertainty rests on one of these; NaN elsewhere."""
    basis = numbers.get(f"{axis}_uncertainty_from")
    if basis is None:
        return numbers
    codes = [flag.value for flag in access.occurring(basis) if flag.flag in flags]
    return numbers.where(basis.isin(codes))


def _uncertainty(numbers: xr.Dataset, axis: str) -> Cell:
    """Return the largest numerical uncertainty, with a reason where nothing bounds it."""
    cell = largest(numbers, f"{axis}_uncertainty")
    endless = np.isinf(numbers[f"{axis}_uncertainty"])
    if not endless.any():
        return cell
    basis = numbers.get(f"{axis}_uncertainty_from", xr.DataArray())
    bounded = [flag.value for flag in access.occurring(basis) if flag.flag != "nothing"]
    zero = bool((endless & basis.isin(bounded)).any())
    return replace(cell, detail="the finest value is zero" if zero else "nothing bounds the error")


def _points_cells(analysis: xr.Dataset, needs: Needs, name: str) -> dict[str, Cell]:
    """Return the points that each rule needs for one response, and its uncertainty."""
    head = f"Points needed for {labels.percent(TOLERANCE)}"
    by_rule = finest(analysis["points_needed"].sel(response=name), needs.runs, but="rule")
    cells = {head: by_rule}
    if "rule" in by_rule.dims:
        rules = labels.values(by_rule["rule"], range(by_rule.sizes["rule"]))
        cells = {
            f"{head}, {rule}": by_rule.isel(rule=position) for position, rule in enumerate(rules)
        }
    uncertain = largest(needs.analysis.sel(response=name), "points_uncertainty")
    return {head: _most(counts.values) for head, counts in cells.items()} | {
        "Numerical uncertainty with the most points": uncertain
    }


def _spread(numbers: xr.Dataset, variable: str) -> Cell:
    values = numbers.get(variable, xr.DataArray()).values
    finite = values[np.isfinite(values)]
    return Cell(labels.span(finite, 3) if finite.size else "–", "number")


def _most(counts: Floats) -> Cell:
    """Return the most points that a case needs; say where a case needs more than there are."""
    if np.isnan(counts).any():
        return Cell("none of this study", "warning")
    return Cell(labels.number(float(counts.max()), 4), "number")
