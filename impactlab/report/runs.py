"""Sections on the runs of a study: its inputs, how the runs ended, and its results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import (
    count,
    design_dims,
    is_sample,
    names,
    responses,
    usable,
    varied,
)
from impactlab.figures.labels import Display, display
from impactlab.figures.measures import analysed
from impactlab.model.parameters import PARAMETERS
from impactlab.report.page import Cell, Section, Table
from impactlab.variables import attributes

_GRID_VALUES = 12
"""A longer list of values of a grid is replaced by its range."""
_FAILED_RUNS = 20
"""Largest number of failed runs listed one by one."""
_PRINTED_RUNS = 48
"""Grids up to this size are printed run by run."""
_COLUMNS = 6
"""Responses side by side in a printed table."""
_QUANTILES = {"5th percentile": 0.05, "Median": 0.5, "95th percentile": 0.95}


def inputs(runs: xr.Dataset) -> Section:
    """Return the section on the varied and the fixed parameters."""
    title = "What was varied, and how" if is_sample(runs) else "What was run"
    tables = [varied_parameters(runs), _fixed_parameters(runs)]
    return Section("runs", title, tables=[table for table in tables if table.rows])


def outcome(runs: xr.Dataset, analysis: xr.Dataset, figures: tuple[str, ...] = ()) -> Section:
    """Return the section on failed runs: how many, which and why.

    A run failed when its status says so, or when one of its responses is missing.
    """
    failed, total = access.failed(runs), count(runs)
    number, imputed = int(failed.sum()), list(_imputed(runs, analysis))
    title = "How the runs ended"
    if not number:
        return Section("outcome", title, f"All {total} runs gave every response.", imputed)
    lead = f"{number} of {total} runs failed: each lacks at least one response."
    causes = access.causes(runs, failed)
    rows = [[Cell(labels.sentence(why)), Cell(str(n), "number")] for why, n in causes.items()]
    tables = [
        Table("Reasons for the failures", ["Reason", "Runs"], rows),
        _failed_runs(runs, failed, number),
    ]
    return Section("outcome", title, lead, imputed, tables, list(figures))


def results(runs: xr.Dataset, figures: tuple[str, ...] = ()) -> Section:
    """Return the section on the range of every response, and all values of a small grid."""
    title = "Distribution of each response" if figures else "Results"
    return Section("results", title, tables=[_ranges(runs), *_all(runs)], figures=list(figures))


def varied_parameters(runs: xr.Dataset) -> Table:
    """Return one row per varied parameter: its values, or its distribution and group."""
    groups = dict(zip(names(runs, "varied"), names(runs, "groups"), strict=False))
    rows = [
        [
            Cell(labels.sentence(labels.parameter(name))),
            *_inputs(_described(runs, name)),
            *([Cell(groups[name].replace("_", " "))] if groups else []),
            Cell(name, "muted"),
        ]
        for name in varied(runs)
    ]
    head = ["Parameter", "Values", "Number", *["Group"] * bool(groups), "Key"]
    return Table("Varied parameters", head, rows)


def _fixed_parameters(runs: xr.Dataset) -> Table:
    rows = []
    for name in [*PARAMETERS, "duration"]:
        if name in runs.coords and runs[name].ndim == 0 and name not in varied(runs):
            coordinate = _described(runs, name)
            label = coordinate.attrs["long_name"]
            text = labels.values(coordinate.expand_dims("one"), [0])[0] + labels.unit(coordinate)
            rows.append([Cell(labels.sentence(label)), Cell(text), Cell(name, "muted")])
    return Table("Parameters that are the same in every run", ["Parameter", "Value", "Key"], rows)


def _described(runs: xr.Dataset, name: str) -> xr.DataArray:
    """Return a coordinate with the attributes of the model's table, where that has it."""
    table = attributes(name) if name in (*PARAMETERS, "duration") else {}
    return runs[name].assign_attrs(table | runs[name].attrs)


def _inputs(coordinate: xr.DataArray) -> list[Cell]:
    unit, size = labels.unit(coordinate), coordinate.size
    if "distribution" in coordinate.attrs:
        return [Cell(_distribution(coordinate)), Cell(f"{size} draws", "number")]
    if size <= _GRID_VALUES or coordinate.dtype.kind not in "if":
        return [Cell(", ".join(labels.values(coordinate, range(size))) + unit), Cell(str(size))]
    ends = [int(np.argmin(coordinate.values)), int(np.argmax(coordinate.values))]
    return [Cell(" to ".join(labels.values(coordinate, ends)) + unit), Cell(str(size))]


def _distribution(coordinate: xr.DataArray) -> str:
    """Return a distribution with its arguments: "uniform: low 250 MPa, high 450 MPa"."""
    scale, unit = display(coordinate).scale, labels.unit(coordinate)
    arguments = []
    for key, value in coordinate.attrs.items():
        if key in ("distribution", "units", "long_name"):
            continue
        factor = "geometric" in key  # a ratio, without the parameter's unit
        number = labels.number(float(value) * (1.0 if factor else scale))
        shown = number + ("" if factor else unit)
        arguments.append(f"{key.replace('_', ' ')} {shown}")
    return f"{str(coordinate.attrs['distribution']).replace('_', '-')}: {', '.join(arguments)}"


def _imputed(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[str]:
    """Yield one sentence per response whose indices rest on values from a surrogate."""
    if "imputed_share" not in analysis:
        return
    for name in analysed(runs, analysis):
        share = float(np.nan_to_num(analysis["imputed_share"].sel(response=name)))
        if share > 0:
            yield (
                f"For the indices of the {labels.response(name)}, a surrogate supplied the value "
                f"of {labels.number(100 * share, 2)} % of the runs."
            )


def _failed_runs(runs: xr.Dataset, failed: xr.DataArray, number: int) -> Table:
    dims = design_dims(runs, failed.dims)
    positions = list(zip(*failed.transpose(*dims).values.nonzero(), strict=True))
    rows = []
    for position in positions[:_FAILED_RUNS]:
        where = {dim: int(at) for dim, at in zip(dims, position, strict=True)}
        why = access.causes(runs.isel(where), xr.DataArray(True))
        absent = [
            labels.response(name)
            for name in responses(runs)
            if bool(access.absent(usable(runs, name).isel(where)))
        ]
        listed = "all" if len(absent) == len(responses(runs)) else labels.listing(absent)
        rows.append([Cell(_place(runs, where)), Cell("; ".join(why), "warning"), Cell(listed)])
    more = f" (the first {_FAILED_RUNS} of {number})" if number > _FAILED_RUNS else ""
    return Table(f"Failed runs{more}", ["Run", "Reason", "Missing responses"], rows)


def _place(runs: xr.Dataset, where: dict[str, int]) -> str:
    """Return the run's number in a sample and its varied parameters, in words."""
    named = [f"run {where['run']}"] if "run" in where else []
    for name in varied(runs):
        text = labels.values(runs[name], [where[str(dim)] for dim in runs[name].dims])[0]
        named.append(f"{labels.parameter(name)} = {text}{labels.unit(runs[name])}")
    return ", ".join(named) or "the only run"


def _ranges(runs: xr.Dataset) -> Table:
    """Return one row per response: unit, smallest and largest value, number of missing values.

    A grid names the runs of the extremes; a sample has percentiles between them.
    """
    sample = is_sample(runs)
    middle = list(_QUANTILES) if sample else []
    head = ["Response", "Unit", "Smallest", *middle, "Largest", "Runs missing"]
    rows = [_range(runs, name, sample) for name in responses(runs)]
    return Table("Range of each response", head, rows)


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


def _extreme(
    runs: xr.Dataset, array: xr.DataArray, pick: Callable[[Any], Any], unit: Display
) -> Cell:
    """Return the smallest or largest value, with its run unless all values are the same."""
    position = np.unravel_index(int(pick(array.values)), array.shape)
    where = {str(dim): int(i) for dim, i in zip(array.dims, position, strict=True)}
    value = labels.number(float(unit(array.values[position])))
    same = np.nanmin(array.values) == np.nanmax(array.values)
    return Cell(value, "number", "in every run" if same else _place(runs, where))


def _all(runs: xr.Dataset) -> list[Table]:
    """Return all values of a small grid, a few responses per table; none for other studies."""
    if is_sample(runs) or count(runs) > _PRINTED_RUNS:
        return []
    shown = responses(runs)
    groups = [shown[at : at + _COLUMNS] for at in range(0, len(shown), _COLUMNS)]
    return [_values(runs, group, f"{i} of {len(groups)}") for i, group in enumerate(groups, 1)]


def _values(runs: xr.Dataset, shown: list[str], part: str) -> Table:
    dims = [dim for dim in design_dims(runs) if runs.sizes[dim] > 1]
    units = {name: display(runs[name]) for name in shown}
    head = []
    for dim in dims:
        unit = labels.unit(runs[dim]).strip()
        head.append(labels.sentence(labels.parameter(dim)) + (f" ({unit})" if unit else ""))
    head += [labels.axis(labels.response(name), units[name].symbol) for name in shown]
    arrays = {name: usable(runs, name).squeeze() for name in shown}
    rows = []
    for position in product(*(range(runs.sizes[dim]) for dim in dims)):
        where = dict(zip(dims, position, strict=True))
        row = [Cell(labels.values(runs[dim], [at])[0], "number") for dim, at in where.items()]
        for name in shown:
            value = float(units[name](arrays[name].isel(where)))
            row.append(Cell(labels.number(value), "number" if np.isfinite(value) else "warning"))
        rows.append(row)
    return Table(f"Every run, responses {part}", head, rows)
