"""Tables of sensitivity indices, and the section on their numerical uncertainty."""

from __future__ import annotations

from functools import partial
from itertools import combinations

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, SOBOL, Family, analysed
from impactlab.report.page import Cell, Row, Section, Table, largest

_FINE = 0.005
"""Half-width below which a third decimal means something."""
_LEAST = 0.001
"""Magnitude below which an index and its half-width are not printed separately."""
_TINY = 0.001
"""Share below which an uncertainty is only bounded."""
_LEAD = (
    "The runs have a numerical error, which was estimated by refining the discretisation. An index "
    "that this error could change by as much as its own value is not distinguishable from it, "
    "however narrow the interval, and no sentence calls it significant."
)
_BASES = {
    "measured": (
        " The error of the indices was measured where the first runs of the sample were solved "
        "again on finer grids; a change that is common to all runs changes no index."
    ),
    "bound": (
        " Where it is only a bound, it follows from the errors of corner cases and is usually far "
        "too large; impactlab refine measures it for a Sobol sample whose runs do not fail."
    ),
}
"""What the numerical error rests on, by the flags of `numerical_from`."""
_OF_RESPONSES = {
    "numerical_uncertainty": "Numerical uncertainty",
    "numerical_share": "Share of the variance that could be numerical",
}


def tables(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Table]:
    """Return one table per measure: responses by parameters, index ± half-width; the dummy last."""
    parameters = [labels.sentence(labels.parameter(name)) for name in measures.parameters(analysis)]
    found = []
    for measure in family.measures_in(analysis):
        dummy = f"dummy_{measure.name}"
        rows: list[Row] = []
        for name in analysed(runs, analysis):
            index = measures.index(analysis, measure.name, name)
            written = partial(in_units, runs[name]) if family is MORRIS else with_margin
            row = [named(analysis, name)]
            for at, (value, margin) in enumerate(zip(index.values, index.margins, strict=True)):
                text = written(value, margin)
                detail = "below numerical error" if index.numerically_lost[at] else ""
                row.append(Cell(text, "number" if index.significant[at] else "muted", detail))
            if dummy in analysis:
                row.append(Cell(_index(analysis.sel(response=name), dummy)[0], "muted"))
            rows.append(row)
        head = ["Response", *parameters, *["Dummy parameter"] * (dummy in analysis)]
        found.append(Table(_caption(f"{family.title}, {measure.words}", analysis), head, rows))
    return found


def second_order(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per pair of parameters, one column per response; noise is grey."""
    names, shown = measures.parameters(analysis), analysed(runs, analysis)
    rows: list[Row] = []
    for first, second in combinations(range(len(names)), 2):
        pair = f"{labels.parameter(names[first])} and {labels.parameter(names[second])}"
        row = [Cell(labels.sentence(pair))]
        for name in shown:
            at = analysis.isel(parameter=first, other_parameter=second).sel(response=name)
            text, significant = _index(at, "second_order")
            row.append(Cell(text, "number" if significant else "muted"))
        rows.append(row)
    head = ["Pair", *(labels.sentence(labels.response(name)) for name in shown)]
    return Table(_caption("Second-order Sobol indices", analysis), head, rows)


def _index(at: xr.Dataset, name: str) -> tuple[str, bool]:
    """Return one index with its half-width as text, and whether it exceeds that half-width."""
    value = float(at[name])
    margin = float(at.get(f"{name}_interval", np.inf))
    return with_margin(value, margin), abs(value) > margin


def _caption(title: str, analysis: xr.Dataset) -> str:
    return f"{title}, with half-widths of the {access.confidence(analysis)} intervals"


def named(analysis: xr.Dataset, response: str) -> Cell:
    """Return the response, with its verdict where that is a warning."""
    found = access.verdict(analysis, "sensitivity_verdict", response)
    detail = found.words if found and not found.sound else ""
    return Cell(labels.sentence(labels.response(response)), "warning" if detail else "", detail)


def with_margin(value: float, margin: float) -> str:
    """Return a number without unit and the half-width of its interval: "0.71 ± 0.03"."""
    if not np.isfinite(value):
        return "undefined"
    if max(abs(value), margin) < _LEAST:
        return f"below {_LEAST}"
    decimals = 3 if margin < _FINE else 2
    text = f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")
    return f"{text} ± {margin:.{decimals}f}" if np.isfinite(margin) else text


def uncertainty(share: float) -> str:
    """Return a relative uncertainty in per cent: "± 1.5 %"; a tiny one is only bounded."""
    return f"± {labels.percent(share)}" if share >= _TINY else f"below {labels.percent(_TINY)}"


def in_units(response: xr.DataArray, value: float, margin: float = np.inf) -> str:
    """Return an effect in the response's display unit: "12.3 kN ± 0.4"."""
    if not np.isfinite(value):
        return "undefined"
    unit = display(response)
    text = labels.number(float(unit(value)), 3) + labels.unit(response)
    return f"{text} ± {labels.number(float(unit(margin)), 2)}" if np.isfinite(margin) else text


def numerical_sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the numerical uncertainty, or none where the analysis has none.

    Its table has one row per response: its uncertainty, and the largest error of an index per
    order.
    """
    based = "numerical_from" in analysis
    if not based and not any(key in analysis for key in _OF_RESPONSES):
        return []
    flags = {each.flag for each in access.occurring(analysis["numerical_from"])} if based else set()
    lead = _LEAD + "".join(text for flag, text in _BASES.items() if flag in flags)
    orders = {
        f"{order.name}_numerical": f"Largest numerical error of the indices of {order.words}"
        for order in SOBOL.measures
        if f"{order.name}_numerical" in analysis
    }
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        found = analysis.sel(response=name)
        cells = [largest(found, key) for key in _OF_RESPONSES]
        cells += [largest(found, key, labels.number) for key in orders]
        basis = access.verdict(analysis, "numerical_from", name)
        rows.append([named(analysis, name), *cells, *([Cell(basis.words)] if basis else [])])
    head = ["Response", *_OF_RESPONSES.values(), *orders.values(), *["Basis"] * based]
    table = Table("Numerical uncertainty of each response", head, rows)
    return [Section("numerical", "Numerical uncertainty", lead, tables=[table])]
