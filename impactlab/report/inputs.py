"""What was run: the varied parameters and the fixed ones."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import names, varied
from impactlab.figures.labels import display
from impactlab.model.parameters import PARAMETERS
from impactlab.report.table import Cell, Table
from impactlab.variables import attributes

_LISTED = 12
"""Up to so many values of a grid are listed; beyond, their range is given."""


def varied_parameters(runs: xr.Dataset) -> Table:
    """A row a varied parameter: its values on a grid, or its distribution and group in a sample."""
    groups = dict(zip(names(runs, "varied"), names(runs, "groups"), strict=False))
    rows = [
        [
            Cell(labels.sentence(labels.parameter(name))),
            *_values(_described(runs, name)),
            *([Cell(groups[name].replace("_", " "))] if groups else []),
            Cell(name, "muted"),
        ]
        for name in varied(runs)
    ]
    head = ["Parameter", "Values", "Number", *["Group"] * bool(groups), "Key"]
    return Table("Varied parameters", head, rows)


def fixed_parameters(runs: xr.Dataset) -> Table:
    """A row a parameter that is the same in every run."""
    rows = []
    for name in [*PARAMETERS, "duration"]:
        if name in runs.coords and runs[name].ndim == 0 and name not in varied(runs):
            coordinate = _described(runs, name)
            label = coordinate.attrs["long_name"]
            text = labels.values(coordinate.expand_dims("one"), [0])[0] + labels.unit(coordinate)
            rows.append([Cell(labels.sentence(label)), Cell(text), Cell(name, "muted")])
    return Table("Parameters that are the same in every run", ["Parameter", "Value", "Key"], rows)


def _described(runs: xr.Dataset, name: str) -> xr.DataArray:
    """With the attributes of the table, where it knows the parameter."""
    table = attributes(name) if name in (*PARAMETERS, "duration") else {}
    return runs[name].assign_attrs(table | runs[name].attrs)


def _values(coordinate: xr.DataArray) -> list[Cell]:
    unit, size = labels.unit(coordinate), coordinate.size
    if "distribution" in coordinate.attrs:
        return [Cell(_distribution(coordinate)), Cell(f"{size} draws", "number")]
    if size <= _LISTED or coordinate.dtype.kind not in "if":
        return [Cell(", ".join(labels.values(coordinate, range(size))) + unit), Cell(str(size))]
    ends = [int(np.argmin(coordinate.values)), int(np.argmax(coordinate.values))]
    return [Cell(" to ".join(labels.values(coordinate, ends)) + unit), Cell(str(size))]


def _distribution(coordinate: xr.DataArray) -> str:
    """Its name and arguments: "uniform: low 250 MPa, high 450 MPa"."""
    scale, unit = display(coordinate).scale, labels.unit(coordinate)
    arguments = []
    for key, value in coordinate.attrs.items():
        if key in ("distribution", "units", "long_name"):
            continue
        factor = "geometric" in key  # a ratio, without the parameter's unit
        shown = labels.number(float(value) * (1.0 if factor else scale)) + ("" if factor else unit)
        arguments.append(f"{key.replace('_', ' ')} {shown}")
    return f"{str(coordinate.attrs['distribution']).replace('_', '-')}: {', '.join(arguments)}"
