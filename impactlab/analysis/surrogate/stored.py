"""surrogate.nc: all that predicts, in one file, without the runs or what fitted it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.surrogate.predicting import Surrogate
from impactlab.model.distributions import arguments

_OF_RESPONSE = ("verdict", "q2", "rmse", "runs")


def packed(runs: xr.Dataset, analysis: xr.Dataset) -> xr.Dataset | None:
    """The surrogates of a sample as a dataset of their own; None where the analysis has none.

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
    """The surrogates of a study from its surrogate.nc.

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
    """The bounds of a parameter's distribution, or its extreme draws where it has none."""
    ends = {"low": column.min(), "high": column.max()} | arguments(column.attrs)
    return float(ends["low"]), float(ends["high"])
