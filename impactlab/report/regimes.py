"""Regimes of responses, and jumps along grids, as entries of the answer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
import xarray as xr

from impactlab.analysis.distribution import drawn_outputs, filtered
from impactlab.analysis.regimes import jumps, of_runs
from impactlab.figures import labels
from impactlab.figures.access import design_dims, is_sample, physical, responses, usable
from impactlab.figures.labels import display
from impactlab.methods import independent_runs
from impactlab.methods.runs import Sample
from impactlab.report.distribution import leading
from impactlab.types import Floats
from impactlab.variables import of_function


def regime_entries(runs: xr.Dataset) -> list[tuple[str, str]]:
    """Return one entry per response of a sample in several regimes: where draws lie, and why."""
    entries = []
    for name in responses(runs):
        if (middles := of_runs(runs, name)).size:
            subject = f"{labels.sentence(labels.response(name))} in several regimes"
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


def jump_entries(runs: xr.Dataset) -> list[tuple[str, str]]:
    """Return one entry per response that jumps along a parameter of a grid: the largest jump."""
    entries = []
    for name in [] if is_sample(runs) else responses(runs):
        round_off = name == "energy_error" and not of_function(runs)
        if not round_off and (sizes := sorted(_jumps(runs, name), reverse=True)):
            text = sizes[0][1]
            if len(sizes) > 1:
                text += f", the largest of {labels.counted(len(sizes), 'jump')}"
            entries.append((f"{labels.sentence(labels.response(name))} jumps", text))
    return entries


def _jumps(runs: xr.Dataset, name: str) -> Iterator[tuple[float, str]]:
    """Yield the size and the description of each jump of a response along a physical parameter."""
    array, unit = usable(runs, name), labels.unit(runs[name])
    dims = design_dims(runs, array.dims)
    for dim in (dim for dim in physical(runs) if dim in dims):
        ordered = array.sortby(dim)
        across = [other for other in dims if other != dim]
        for place in product(*(range(ordered.sizes[other]) for other in across)):
            where = dict(zip(across, place, strict=True))
            curve = ordered.isel(where)
            for position in jumps(curve[dim].values.astype(float), curve.values).tolist():
                ends = curve[[position, position + 1]]
                low, high = (labels.number(float(end), 3) for end in display(runs[name])(ends))
                text = f"from {low} to {high}{unit} between "
                text += labels.listing(labels.values(ends[dim], [0, 1])) + labels.unit(ends[dim])
                text += f" of {labels.parameter(runs[dim])}"
                fixed = [labels.setting(runs[key], [i]) for key, i in where.items()]
                text += f" ({', '.join(fixed)})" * bool(fixed)
                yield float(np.ptp(ends.values)), text


def regime_doubt(runs: xr.Dataset, name: str) -> str:
    """Return what is wrong with a mean of a response in several regimes; "" for one regime."""
    if number := of_runs(runs, name).size:
        return f"{number + 1} separate ranges: mean and standard deviation describe none of them"
    return ""
