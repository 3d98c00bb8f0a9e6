"""Tables of sensitivity indices, and the section on their numerical uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.labels import display
from impactlab.figures.measures import MORRIS, SOBOL, Family, Measure, analysed
from impactlab.report.page import Cell, Section, Table

_FINE = 0.005
"""Half-width below which a third decimal means something."""
_LEAST = 0.001
"""Magnitude below which an index and its half-width are not printed separately."""
_LEAD = (
    "The runs have a numerical error, which was estimated by refining the discretisation. An index "
    "that this error could change by as much as its own value is not distinguishable from it, "
    "however narrow the interval, and no sentence calls it significant."
)
_MEASURED = (
    " The error of the indices was measured where the first runs of the sample were solved again "
    "on finer grids; a change that is common to all runs changes no index."
)
_BOUND = (
    " Where it is only a bound, it follows from the errors of corner cases and is usually far too "
    "large; impactlab refine measures it for a Sobol sample whose runs do not fail."
)
_OF_RESPONSES = ("numerical_uncertainty", "numerical_share")
_FROM = "numerical_from"


def tables(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[Table]:
    """Return one table per measure: responses by parameters, index ± half-width; the dummy last."""
    return [_table(runs, analysis, family, measure) for measure in family.measures_in(analysis)]


def second_order(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per pair of parameters, one column per response; noise is grey."""
    names, shown = measures.parameters(analysis), analysed(runs, analysis)
    head = ["Pair", *(labels.sentence(labels.response(name)) for name in shown)]
    rows = []
    for first, second in combinations(range(len(names)), 2):
        pair = f"{labels.parameter(names[first])} and {labels.parameter(names[second])}"
        at = {"parameter": first, "other_parameter": second}
        rows.append([Cell(labels.sentence(pair)), *(_pair(analysis.isel(at), n) for n in shown)])
    return Table(_caption("Second-order Sobol indices", analysis), head, rows)


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


def in_units(response: xr.DataArray, value: float, margin: float) -> str:
    """Return an effect in the response's display unit: "12.3 kN ± 0.4"."""
    if not np.isfinite(value):
        return "undefined"
    unit = display(response)
    symbol = f" {unit.symbol}" if unit.symbol else ""
    text = labels.number(float(unit(value)), 3) + symbol
    return f"{text} ± {labels.number(float(unit(margin)), 2)}" if np.isfinite(margin) else text


def numerical_sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on the numerical uncertainty, or none where the analysis has none."""
    if not any(name in analysis for name in (*_OF_RESPONSES, _FROM)):
        return []
    section = Section(
        "numerical",
        "Numerical uncertainty",
        _lead(analysis),
        numerical_warnings(runs, analysis),
        [_uncertainties(runs, analysis)],
    )
    return [section]


def numerical_warnings(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response and order with indices that numerical error may explain."""
    return [
        text
        for name in analysed(runs, analysis)
        for measure in SOBOL.measures
        if measure.name in analysis
        for text in _lost(analysis, name, measure.name, measure.words)
    ]


def _table(runs: xr.Dataset, analysis: xr.Dataset, family: Family, measure: Measure) -> Table:
    names = measures.parameters(analysis)
    dummy = [f"dummy_{measure.name}"] if f"dummy_{measure.name}" in analysis else []
    head = ["Response", *(labels.sentence(labels.parameter(name)) for name in names)]
    rows = []
    for response in analysed(runs, analysis):
        cells = _cells(runs, analysis, family, measure.name, response)
        cells += [Cell(_index(analysis, name, response)[0], "muted") for name in dummy]
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
        texts = [with_margin(value, margin) for value, margin in pairs]
    lost = found.numerically_lost
    return [
        Cell(text, "number" if stands else "muted", "below numerical error" if gone else "")
        for text, stands, gone in zip(texts, found.significant, lost, strict=True)
    ]


def _pair(analysis: xr.Dataset, response: str) -> Cell:
    text, significant = _index(analysis, "second_order", response)
    return Cell(text, "number" if significant else "muted")


def _index(analysis: xr.Dataset, name: str, response: str) -> tuple[str, bool]:
    """Return an index with its half-width as text, and whether it exceeds that half-width."""
    value = float(analysis[name].sel(response=response))
    interval = analysis.get(f"{name}_interval")
    margin = np.inf if interval is None else float(interval.sel(response=response))
    return with_margin(value, margin), abs(value) > margin


def _lost(analysis: xr.Dataset, name: str, measure: str, label: str) -> Iterator[str]:
    index = measures.index(analysis, measure, name)
    keys = np.array([labels.parameter(key) for key in measures.parameters(analysis)])
    lost = index.numerically_lost
    if lost.any():
        listed = [
            f"{key} ({value:.3f})".replace("-", "−")
            for key, value in zip(keys[lost], index.values[lost], strict=True)
        ]
        bound = labels.number(float(index.numerical[lost].max()), 2)
        yield (
            f"{labels.sentence(labels.response(name))}, {label}: these indices are not "
            "resolved at this discretisation, because the numerical error could change them by as "
            f"much (up to {bound}): {labels.listing(listed)}."
        )


def _lead(analysis: xr.Dataset) -> str:
    """Return the lead, with what the numerical errors of the indices were estimated from."""
    if _FROM not in analysis:
        return _LEAD
    found = {each.flag for each in access.occurring(analysis[_FROM])}
    return _LEAD + _MEASURED * ("measured" in found) + _BOUND * ("bound" in found)


def _uncertainties(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per response: uncertainty, and the largest error of an index per order."""
    orders = [one for one in SOBOL.measures if f"{one.name}_numerical" in analysis]
    head = ["Response", "Numerical uncertainty", "Share of the variance that could be numerical"]
    head += [f"Largest numerical error of the indices of {order.words}" for order in orders]
    rows = []
    for name in analysed(runs, analysis):
        found = analysis.sel(response=name)
        cells = [_largest(found, key, _percent) for key in _OF_RESPONSES]
        cells += [_largest(found, f"{order.name}_numerical", labels.number) for order in orders]
        source = access.verdict(analysis, _FROM, name)
        rows.append([named(analysis, name), *cells, *([Cell(source.words)] if source else [])])
    head += ["Basis"] * (_FROM in analysis)
    return Table("Numerical uncertainty of each response", head, rows)


def _largest(found: xr.Dataset, key: str, text: Callable[[float], str]) -> Cell:
    """Return the largest value over the parameters; a dash where it is not given."""
    value = float(found[key].max()) if key in found else np.nan
    return Cell("–" if np.isnan(value) else text(value), "number")


def _percent(share: float) -> str:
    return f"{labels.number(100 * share, 2)} %"
