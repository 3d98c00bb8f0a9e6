"""Stored surrogates: surrogate.nc, and predictions from it within the ranges of its runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.surrogate.chaos import Array, basis
from impactlab.analysis.surrogate.from_runs import SurrogateVerdict
from impactlab.model.distributions import arguments, cumulative

_AT_ONCE = 4096
"""Number of points whose terms about fit in the processor's cache."""
_VERDICTS = {int(member): member for member in SurrogateVerdict}


class Surrogate:
    """The surrogates of all responses of one study."""

    def __init__(self, dataset: xr.Dataset) -> None:
        """Take the dataset of surrogate.nc (see `packed`)."""
        self.dataset = dataset
        self.parameters: tuple[str, ...] = tuple(map(str, dataset["parameter"].values))
        self.responses: tuple[str, ...] = tuple(map(str, dataset["response"].values))
        self._distributions = [json.loads(text) for text in dataset["distribution"].values]

    def units(self, parameter: str) -> str:
        """Return the SI unit of a parameter. Raises ValueError where it was not varied."""
        self._check_known(parameter)
        return str(self.dataset["parameter_units"].sel(parameter=parameter).item())

    def predict(self, **values: Any) -> xr.Dataset:
        """Predict every response at values of all varied parameters, in SI units.

        values: by name, numbers, arrays of one dimension (`point`) or DataArrays, which are
        broadcast against each other. Returns the responses on the common dimensions, NaN where
        there is no surrogate, each with units, long_name, rmse and q2 (of runs held out) and
        verdict; the values are its coordinates. Raises ValueError, naming parameter, value and
        range, where one is missing, was not varied, or lies outside what the surrogate knows.
        """
        columns = self._columns(values)
        points = np.column_stack([column.values.ravel() for column in columns])
        unit = np.column_stack(
            [cumulative(*pair) for pair in zip(self._distributions, points.T, strict=True)]
        )
        shape, dims = columns[0].shape, columns[0].dims
        found = np.concatenate(list(self._evaluated(unit)), axis=1)
        variables = {
            name: (dims, row.reshape(shape), self._attributes(name))
            for name, row in zip(self.responses, found, strict=True)
        }
        coords = dict(zip(self.parameters, columns, strict=True))
        return xr.Dataset(variables, coords)

    def _columns(self, values: dict[str, Any]) -> list[xr.DataArray]:
        """Return the checked values in the order of the parameters, of one shape."""
        for name in values:
            self._check_known(name)
        if absent := [name for name in self.parameters if name not in values]:
            raise ValueError(f"{', '.join(absent)}: no value is given; {self._hint()}")
        arrays = [_array(name, values[name]) for name in self.parameters]
        for name, array in zip(self.parameters, arrays, strict=True):
            self._check_range(name, array)
        return [
            array.drop_vars(self.parameters, errors="ignore") for array in xr.broadcast(*arrays)
        ]

    def _evaluated(self, unit: Array) -> Iterator[Array]:
        """Yield (responses, points), one batch of points after another."""
        degrees, coefficients = self.dataset["degree"].values, self.dataset["coefficient"].values
        for start in range(0, max(len(unit), 1), _AT_ONCE):
            yield coefficients @ basis(unit[start : start + _AT_ONCE], degrees)

    def _attributes(self, response: str) -> dict[str, Any]:
        entry = self.dataset.sel(response=response)
        return {
            "long_name": str(entry["response_long_name"].item()),
            "units": str(entry["response_units"].item()),
            "rmse": float(entry["rmse"]),
            "q2": float(entry["q2"]),
            "verdict": _VERDICTS[int(entry["verdict"])].name.lower(),
        }

    def _check_known(self, name: str) -> None:
        if name in self.parameters:
            return
        held = self.dataset.coords.get(name)
        words = "" if held is None else f" (it is {held.item()!r} in all of its runs)"
        raise ValueError(f"{name}: was not varied in study {self._study()}{words}; {self._hint()}")

    def _check_range(self, name: str, array: xr.DataArray) -> None:
        entry = self.dataset.sel(parameter=name)
        low, high = float(entry["lowest"]), float(entry["highest"])
        outside = ~((array.values >= low) & (array.values <= high))
        if outside.any():
            worst = float(array.values[outside][0])
            raise ValueError(
                f"{name} = {worst!r}: outside {low!r} to {high!r} ({self.units(name)}), where the "
                f"surrogate of study {self._study()} was trained: choose a value within, or "
                "sample a wider range"
            )

    def _hint(self) -> str:
        return f"the surrogate takes {', '.join(self.parameters)}"

    def _study(self) -> str:
        return repr(self.dataset.attrs.get("study", "?"))


def _array(name: str, value: Any) -> xr.DataArray:
    """Return a parameter's values as floats. Raises ValueError where they are not numbers."""
    if isinstance(value, xr.DataArray):
        return value.astype(float)
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r}: expected numbers in SI units") from None
    if array.ndim > 1:
        raise ValueError(
            f"{name}: has {array.ndim} dimensions: give a number, a list, or a DataArray"
        )
    return xr.DataArray(array, dims=("point",)[: array.ndim])


_OF_RESPONSE = ("verdict", "q2", "rmse", "runs")


def packed(runs: xr.Dataset, analysis: xr.Dataset) -> xr.Dataset | None:
    """Return the surrogates of a sample as a dataset; None where the analysis has none.

    Variables, without the prefix that they have in `analysis`: coefficient (response, term),
    degree (term, parameter), verdict, q2, rmse and runs (response); on (parameter): distribution
    (its name and arguments as JSON, in SI units), lowest and highest (between which it was
    trained), parameter_units, parameter_long_name. Parameters that were not varied are scalar
    coordinates, as in the runs; so are the attributes.
    """
    if "surrogate_coefficient" not in analysis:
        return None
    names = {"surrogate_term": "term", "surrogate_input": "parameter"}
    names |= {f"surrogate_{name}": name for name in ("coefficient", "degree", *_OF_RESPONSE)}
    kept = [name for name in names if name in analysis.data_vars]
    dataset = analysis[kept].drop_vars("parameter", errors="ignore").rename(names)
    held = {name: array for name, array in runs.coords.items() if array.ndim == 0}
    return dataset.assign(_inputs(runs, dataset)).assign_coords(held).assign_attrs(runs.attrs)


def load_surrogate(path: str | Path) -> Surrogate:
    """Load the surrogates of a study from its surrogate.nc.

    Raises OSError, naming a file that cannot be read, and ValueError where it holds no surrogate.
    """
    try:
        dataset = xr.load_dataset(path, engine="netcdf4")
    except (OSError, ValueError, RuntimeError) as error:
        raise OSError(f"{path}: cannot be read as netCDF ({error})") from None
    if absent := {"coefficient", "degree", "distribution"} - set(dataset.data_vars):
        raise ValueError(
            f"{path}: is no surrogate, for it has no {', '.join(sorted(absent))}: "
            "name the surrogate.nc that `impactlab analyse` wrote"
        )
    return Surrogate(dataset)


def _inputs(runs: xr.Dataset, dataset: xr.Dataset) -> dict[str, Any]:
    columns = [runs[str(name)] for name in dataset["parameter"].values]
    ends = np.array([_range(column) for column in columns])
    texts = {
        "distribution": [json.dumps(arguments(column.attrs)) for column in columns],
        "parameter_units": [column.attrs.get("units", "1") for column in columns],
        "parameter_long_name": [column.attrs.get("long_name", "") for column in columns],
    }
    return {name: ("parameter", values) for name, values in texts.items()} | {
        "lowest": ("parameter", ends[:, 0], {"long_name": "lowest value trained on, SI"}),
        "highest": ("parameter", ends[:, 1], {"long_name": "highest value trained on, SI"}),
    }


def _range(column: xr.DataArray) -> tuple[float, float]:
    """Return the bounds of a parameter's distribution, or its extreme draws."""
    ends = {"low": column.min(), "high": column.max()} | arguments(column.attrs)
    return float(ends["low"]), float(ends["high"])
