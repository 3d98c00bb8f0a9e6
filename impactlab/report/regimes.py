"""Regimes of responses, and jumps along grids, as entries of the answer."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.distribution import drawn_outputs, filtered
from impactlab.analysis.regimes import of_runs
from impactlab.figures import labels
from impactlab.figures.access import responses
from impactlab.figures.labels import display
from impactlab.methods import independent_runs
from impactlab.methods.runs import Sample
from impactlab.report.distribution import leading
from impactlab.report.page import Entry
from impactlab.types import Floats


def regime_entries(runs: xr.Dataset) -> list[Entry]:
    """Return one entry per response of a sample in several regimes: where draws lie, and why."""
    entries = []
    for name in responses(runs):
        if (middles := of_runs(runs, name)).size:
            subject = f"{labels.title(name)} in several regimes"
            entries.append((subject, _regimes(runs, name, middles)))
    return entries


def _regimes(runs: xr.Dataset, name: str, middles: Floats) -> str:
    """Return the range of each regime, and the parameters that decide between them."""
    values, unit = drawn_outputs(runs, name), display(runs[name])
    places = np.where(np.isfinite(values), np.searchsorted(middles, values), np.nan)
    parts = [unit(values[places == place]) for place in range(middles.size + 1)]
    common = max(range(len(parts)), key=lambda place: parts[place].size)
    total, usual = np.isfinite(places).sum(), float(np.median(parts[common]))
    texts = []
    for part in (part for part in parts if part is not parts[common]):
        text = f"{labels.span(part, 3)}{labels.unit(runs[name])}"
        if usual > 0 and (ratio := float(np.median(part)) / usual) > 0:
            text = f"about {labels.number(ratio, 2)} times as much ({text})"
        texts.append(f"{text} in {labels.percent(part.size / total)}")
    text = f"{labels.span(parts[common], 3)}{labels.unit(runs[name])} in "
    text += f"{labels.percent(parts[common].size / total)} of the draws, but "
    text += f"{labels.listing(texts)}, and none between"
    apart = np.where(np.isfinite(places), places != common, np.nan)
    if decisive := _decisive(runs, name, apart):
        text += f"; the latter have {decisive}"
    return f"{text}; no mean, index or surrogate describes them all"


def _decisive(runs: xr.Dataset, name: str, apart: Floats) -> str:
    """Return the parameters that differ most between runs apart (1) and the others (0)."""
    sample = Sample.of(runs.assign_attrs(responses=name))
    rows = independent_runs(sample)
    columns = {key: sample.runs[key].values[rows] for key in sample.parameters}
    columns = {key: column for key, column in columns.items() if np.unique(column).size > 1}
    variables = {
        key: (("response", "varied_parameter"), [numbers])
        for key, numbers in filtered(apart, 0.5, columns).items()
    }
    coordinates = {"response": [name], "varied_parameter": list(columns)}
    return leading(runs, xr.Dataset(variables, coordinates, runs.attrs), name)


def regime_doubt(runs: xr.Dataset, name: str) -> str:
    """Return what is wrong with a mean of a response in several regimes; "" for one regime."""
    if number := of_runs(runs, name).size:
        return f"{number + 1} separate ranges: mean and standard deviation describe none of them"
    return ""
