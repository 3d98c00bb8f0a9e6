"""The numerical uncertainty of a sample's responses beside their indices."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab.figures.reading import measures, words
from impactlab.figures.reading.measures import SOBOL, asked
from impactlab.report.indices import named
from impactlab.report.section import Section
from impactlab.report.table import Cell, Table

_LEAD = (
    "The runs carry a numerical error, estimated by refining the discretisation. Its share in the "
    "variance is the square of the error over the standard deviation of the response; an index "
    "below its bound could come from the discretisation alone, and is not named in any sentence."
)


def given(analysis: xr.Dataset) -> bool:
    """Whether the analysis knows the numerical uncertainty."""
    return "numerical_uncertainty" in analysis


def section(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Uncertainties in a table, and a sentence on the indices below them."""
    return Section(
        "numerical",
        "Numerical uncertainty",
        _LEAD,
        warnings(runs, analysis),
        [_table(runs, analysis)],
    )


def warnings(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """A sentence for each response and order with indices below their numerical bound."""
    return [
        text
        for name in asked(runs, analysis)
        for measure in SOBOL.measures
        if measure.name in analysis
        for text in _lost(analysis, name, measure.name, measure.words)
    ]


def _lost(analysis: xr.Dataset, name: str, measure: str, label: str) -> Iterator[str]:
    index = measures.index(analysis, measure, name)
    keys = np.array([words.parameter(key) for key in measures.parameters(analysis)])
    lost = index.numerically_lost
    if lost.any():
        told = [
            f"{key} ({value:.3f})".replace("-", "−")
            for key, value in zip(keys[lost], index.values[lost], strict=True)
        ]
        bound = words.number(float(index.numerical[lost].max()), 2)
        yield (
            f"{words.sentence(words.response(name))}, {label}: not resolved at this "
            "discretisation, for the numerical error could change these indices by as much (up to "
            f"{bound}): {words.listing(told)}."
        )


def _table(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    head = ["Response", "Numerical uncertainty", "Share of the variance that could be numerical"]
    rows = []
    for name in asked(runs, analysis):
        found = analysis.sel(response=name)
        shares = [
            Cell(_percent(float(found[key])), "number") if key in found else Cell("–", "number")
            for key in ("numerical_uncertainty", "numerical_share")
        ]
        rows.append([named(analysis, name), *shares])
    return Table("Numerical uncertainty of each response", head, rows)


def _percent(share: float) -> str:
    return "unknown" if np.isnan(share) else f"{words.number(100 * share, 2)} %"
