"""Headline results: the range of every response, and all values of a small grid."""

from __future__ import annotations

from itertools import product

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import count, design_dims, is_sample, responses, usable
from impactlab.figures.labels import Display, display
from impactlab.report.outcome import place
from impactlab.report.table import Cell, Table

_MOST_RUNS = 48
"""Grids up to this size are printed run by run."""
_COLUMNS = 6
"""Responses side by side in a printed table."""
_QUANTILES = {"5th percentile": 0.05, "Median": 0.5, "95th percentile": 0.95}


def ranges(runs: xr.Dataset) -> Table:
    """A row a response: what it is, its unit, its smallest and largest value, what is missing.

    On a grid with the runs they occur in; in a sample with percentiles between them.
    """
    sample = is_sample(runs)
    middle = list(_QUANTILES) if sample else []
    head = ["Response", "Unit", "Smallest", *middle, "Largest", "Runs missing"]
    rows = [_range(runs, name, sample) for name in responses(runs)]
    return Table("Range of each response", head, rows)


def values(runs: xr.Dataset) -> list[Table]:
    """All values of a small grid, a few responses a table; none for samples and large grids."""
    if is_sample(runs) or count(runs) > _MOST_RUNS:
        return []
    names = responses(runs)
    groups = [names[at : at + _COLUMNS] for at in range(0, len(names), _COLUMNS)]
    return [_values(runs, group, f"{i} of {len(groups)}") for i, group in enumerate(groups, 1)]


def _range(runs: xr.Dataset, name: str, sample: bool) -> list[Cell]:
    array, unit = usable(runs, name), display(runs[name])
    finite = np.isfinite(array.values)
    gaps = int(array.size - finite.sum())
    head = [
        Cell(labels.sentence(labels.response(name)), detail=runs[name].attrs.get("long_name", "")),
        Cell(unit.symbol or "–"),
    ]
    last = Cell(str(gaps), "warning" if gaps else "number")
    if not finite.any():
        return [*head, *[Cell("missing", "warning")] * (5 if sample else 2), last]
    low, high = (_extreme(runs, array, pick, unit) for pick in (np.nanargmin, np.nanargmax))
    if not sample:
        return [*head, low, high, last]
    quantiles = np.quantile(unit(array.values[finite]), list(_QUANTILES.values()))
    middle = [Cell(labels.number(float(value)), "number") for value in quantiles]
    return [*head, Cell(low.text, "number"), *middle, Cell(high.text, "number"), last]


def _extreme(runs: xr.Dataset, array: xr.DataArray, pick: object, unit: Display) -> Cell:
    """The smallest or largest value, with the run that it occurs in unless all are the same."""
    at = int(pick(array.values))  # type: ignore[operator]
    position = np.unravel_index(at, array.shape)
    where = {str(dim): int(i) for dim, i in zip(array.dims, position, strict=True)}
    value = labels.number(float(unit(array.values[position])))
    same = np.nanmin(array.values) == np.nanmax(array.values)
    return Cell(value, "number", "in every run" if same else place(runs, where))


def _values(runs: xr.Dataset, names: list[str], part: str) -> Table:
    dims = [dim for dim in design_dims(runs) if runs.sizes[dim] > 1]
    units = {name: display(runs[name]) for name in names}
    head = [
        labels.sentence(labels.parameter(dim)) + _bracket(labels.unit(runs[dim])) for dim in dims
    ]
    head += [labels.axis(labels.response(name), units[name].symbol) for name in names]
    arrays = {name: usable(runs, name).squeeze() for name in names}
    rows = []
    for position in product(*(range(runs.sizes[dim]) for dim in dims)):
        where = dict(zip(dims, position, strict=True))
        place = [Cell(labels.values(runs[dim], [at])[0], "number") for dim, at in where.items()]
        found = [units[name](arrays[name].isel(where)) for name in names]
        rows.append([*place, *(_value(float(value)) for value in found)])
    return Table(f"Every run, responses {part}", head, rows)


def _bracket(unit: str) -> str:
    return f" ({unit.strip()})" if unit else ""


def _value(value: float) -> Cell:
    return Cell(labels.number(value), "number" if np.isfinite(value) else "warning")
