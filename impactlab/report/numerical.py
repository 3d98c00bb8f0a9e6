"""The numerical uncertainty of a sample's responses beside their indices."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.measures import SOBOL, asked
from impactlab.report.indices import named
from impactlab.report.section import Section
from impactlab.report.table import Cell, Table

_LEAD = (
    "The runs carry a numerical error, estimated by refining the discretisation. An index that it "
    "could change by as much is not told from it, however narrow the interval, and no sentence "
    "names it as significant."
)
_MEASURED = (
    " How far the indices may be off is measured where the first runs of the sample were solved "
    "again on finer grids; what moves all runs alike moves no index."
)
_BOUND = (
    " Where it is only a bound, it follows from the errors of corner cases and is far too large as "
    "a rule: of a Sobol sample whose runs do not fail, impactlab refine measures it."
)
_OF_RESPONSES = ("numerical_uncertainty", "numerical_share")
_FROM = "numerical_from"


def given(analysis: xr.Dataset) -> bool:
    """Whether the analysis knows the numerical uncertainty."""
    return any(name in analysis for name in (*_OF_RESPONSES, _FROM))


def section(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Uncertainties in a table, and a sentence on the indices that they take."""
    return Section(
        "numerical",
        "Numerical uncertainty",
        _lead(analysis),
        warnings(runs, analysis),
        [_table(runs, analysis)],
    )


def warnings(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """A sentence for each response and order with indices that numerical error alone takes."""
    return [
        text
        for name in asked(runs, analysis)
        for measure in SOBOL.measures
        if measure.name in analysis
        for text in _lost(analysis, name, measure.name, measure.words)
    ]


def _lost(analysis: xr.Dataset, name: str, measure: str, label: str) -> Iterator[str]:
    index = measures.index(analysis, measure, name)
    keys = np.array([labels.parameter(key) for key in measures.parameters(analysis)])
    lost = index.numerically_lost
    if lost.any():
        told = [
            f"{key} ({value:.3f})".replace("-", "−")
            for key, value in zip(keys[lost], index.values[lost], strict=True)
        ]
        bound = labels.number(float(index.numerical[lost].max()), 2)
        yield (
            f"{labels.sentence(labels.response(name))}, {label}: not resolved at this "
            "discretisation, for the numerical error could change these indices by as much (up to "
            f"{bound}): {labels.listing(told)}."
        )


def _lead(analysis: xr.Dataset) -> str:
    """With what the numbers of these indices rest on."""
    if _FROM not in analysis:
        return _LEAD
    found = {each.flag for each in access.occurring(analysis[_FROM])}
    return _LEAD + _MEASURED * ("measured" in found) + _BOUND * ("bound" in found)


def _table(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Of each response, and the most that an index of each order may be off."""
    orders = [one for one in SOBOL.measures if f"{one.name}_numerical" in analysis]
    head = ["Response", "Numerical uncertainty", "Share of the variance that could be numerical"]
    head += [f"Indices of {order.words} may be off by up to" for order in orders]
    rows = []
    for name in asked(runs, analysis):
        found = analysis.sel(response=name)
        cells = [_number(found, key, _percent) for key in _OF_RESPONSES]
        cells += [_number(found, f"{order.name}_numerical", labels.number) for order in orders]
        rests = access.verdict(analysis, _FROM, name)
        rows.append([named(analysis, name), *cells, *([Cell(rests.words)] if rests else [])])
    head += ["Which is"] * (_FROM in analysis)
    return Table("Numerical uncertainty of each response", head, rows)


def _number(found: xr.Dataset, key: str, told: Callable[[float], str]) -> Cell:
    """The largest over the parameters; a dash where it is not given."""
    value = float(found[key].max()) if key in found else np.nan
    return Cell("–" if np.isnan(value) else told(value), "number")


def _percent(share: float) -> str:
    return f"{labels.number(100 * share, 2)} %"
