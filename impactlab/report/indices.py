"""Indices in tables: an index is never without its interval, its floor and its verdict."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, Family, Measure, asked
from impactlab.report.table import Cell, Table

_FINE = 0.005
"""Half-width below which a third decimal means something."""
_LEAST = 0.001
"""Magnitude below which an index and its half-width are not told one by one."""


def tables(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Table]:
    """A table a measure: responses by parameters, index ± half-width; the dummy in the end."""
    return [_table(runs, analysis, family, measure) for measure in family.measures_in(analysis)]


def second_order(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """A row a pair of parameters, a column a response; what is not significant is grey."""
    names, shown = measures.parameters(analysis), asked(runs, analysis)
    head = ["Pair", *(labels.sentence(labels.response(name)) for name in shown)]
    rows = []
    for first, second in combinations(range(len(names)), 2):
        pair = f"{labels.parameter(names[first])} and {labels.parameter(names[second])}"
        at = {"parameter": first, "other_parameter": second}
        rows.append([Cell(labels.sentence(pair)), *(_pair(analysis.isel(at), n) for n in shown)])
    return Table(_caption("Second-order Sobol indices", analysis), head, rows)


def named(analysis: xr.Dataset, response: str) -> Cell:
    """The response, with its verdict where that is a warning."""
    found = access.verdict(analysis, "sensitivity_verdict", response)
    detail = found.words if found and not found.sound else ""
    return Cell(labels.sentence(labels.response(response)), "warning" if detail else "", detail)


def told(value: float, margin: float) -> str:
    """A number without unit and the half-width of its interval: "0.71 ± 0.03"."""
    if not np.isfinite(value):
        return "undefined"
    if max(abs(value), margin) < _LEAST:
        return f"below {_LEAST}"
    decimals = 3 if margin < _FINE else 2
    text = f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")
    return f"{text} ± {margin:.{decimals}f}" if np.isfinite(margin) else text


def _table(runs: xr.Dataset, analysis: xr.Dataset, family: Family, measure: Measure) -> Table:
    names = measures.parameters(analysis)
    dummy = [f"dummy_{measure.name}"] if f"dummy_{measure.name}" in analysis else []
    head = ["Response", *(labels.sentence(labels.parameter(name)) for name in names)]
    rows = []
    for response in asked(runs, analysis):
        cells = _cells(runs, analysis, family, measure.name, response)
        cells += [_dummy(analysis, name, response) for name in dummy]
        rows.append([named(analysis, response), *cells])
    title = f"{family.title}, {measure.words}"
    return Table(_caption(title, analysis), [*head, *["Dummy parameter"] * len(dummy)], rows)


def _caption(title: str, analysis: xr.Dataset) -> str:
    return f"{title}, with half-widths of the {access.confidence(analysis)} intervals"


def _cells(
    runs: xr.Dataset, analysis: xr.Dataset, family: Family, measure: str, response: str
) -> list[Cell]:
    found = measures.index(analysis, measure, response)
    pairs = zip(found.values, found.margins, strict=True)
    if family is MORRIS:
        texts = [in_units(runs[response], value, margin) for value, margin in pairs]
    else:
        texts = [told(value, margin) for value, margin in pairs]
    lost = found.numerically_lost
    return [
        Cell(text, "number" if stands else "muted", "below numerical error" if gone else "")
        for text, stands, gone in zip(texts, found.significant, lost, strict=True)
    ]


def in_units(response: xr.DataArray, value: float, margin: float) -> str:
    """An effect in the response's display unit: "12.3 kN ± 0.4"."""
    if not np.isfinite(value):
        return "undefined"
    unit = display(response)
    symbol = f" {unit.symbol}" if unit.symbol else ""
    text = labels.number(float(unit(value)), 3) + symbol
    return f"{text} ± {labels.number(float(unit(margin)), 2)}" if np.isfinite(margin) else text


def _dummy(analysis: xr.Dataset, name: str, response: str) -> Cell:
    value = float(analysis[name].sel(response=response))
    interval = analysis.get(f"{name}_interval")
    margin = np.inf if interval is None else float(interval.sel(response=response))
    return Cell(told(value, margin), "muted")


def _pair(analysis: xr.Dataset, response: str) -> Cell:
    value = float(analysis["second_order"].sel(response=response))
    interval = analysis.get("second_order_interval")
    margin = np.inf if interval is None else float(interval.sel(response=response))
    return Cell(told(value, margin), "number" if abs(value) > margin else "muted")
