"""Synthetic runs datasets, as the data contract has them."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.methods.saltelli import REPLICATES
from impactlab.variables import described

Values = Callable[..., Any]


def _finished(
    variables: Mapping[str, Any], status: xr.DataArray, attrs: Mapping[str, Any]
) -> xr.Dataset:
    fixed = {"gravity": 9.81, "beam_span": 0.78, "duration": 1e-3, "contact": "stronge"}
    fixed |= {"scheme": "leapfrog", "beam_model": "euler_bernoulli"}
    common = {"study": "synthetic", "responses": list(variables), "history_samples": 0}
    dataset = xr.Dataset({**variables, "status": status.astype(np.int32)})
    scalars = {name: value for name, value in fixed.items() if name not in dataset.coords}
    return described(dataset.assign_coords(scalars).assign_attrs(common | dict(attrs)))


@pytest.fixture
def grid_runs() -> Callable[..., xr.Dataset]:
    """Build grid runs: axes by name, and a function of the axes for each response."""

    def build(axes: Mapping[str, Sequence[Any]], **responses: Values) -> xr.Dataset:
        mesh = [xr.DataArray(list(v), dims=n, coords={n: list(v)}) for n, v in axes.items()]
        shape = xr.broadcast(*mesh)
        arrays = {
            name: xr.zeros_like(shape[0], float) + function(**dict(zip(axes, shape, strict=True)))
            for name, function in responses.items()
        }
        status = xr.zeros_like(shape[0], int)
        return _finished(arrays, status, {"method": "grid", "varied": list(axes)})

    return build


@pytest.fixture
def sample_runs() -> Callable[..., xr.Dataset]:
    """Build Sobol runs from outputs in Saltelli's order."""

    def build(
        parameters: Sequence[str],
        base_samples: int,
        *,
        second_order: bool = True,
        seed: int = 0,
        attrs: Mapping[str, Any] | None = None,
        **outputs: Any,
    ) -> xr.Dataset:
        number = len(next(iter(outputs.values())))
        run = {"run": np.arange(number)}
        varied = {name: ("run", np.linspace(1.0, 2.0, number)) for name in parameters}
        arrays = {name: xr.DataArray(np.array(v, float), run) for name, v in outputs.items()}
        own = {
            "method": "sobol",
            "varied": list(parameters),
            "base_samples": base_samples,
            "second_order": int(second_order),
            "replicates": REPLICATES,
            "seed": seed,
        }
        status = xr.DataArray(np.zeros(number, int), run)
        return _finished(arrays, status, own | dict(attrs or {})).assign_coords(varied)

    return build


@pytest.fixture
def stored(tmp_path: Path) -> Callable[[xr.Dataset], xr.Dataset]:
    """The dataset after a way through a netCDF file."""

    def through(dataset: xr.Dataset) -> xr.Dataset:
        path = tmp_path / "stored.nc"
        dataset.to_netcdf(path, engine="netcdf4")
        return xr.load_dataset(path, engine="netcdf4")

    return through


@pytest.fixture
def verdicts_of() -> Callable[[xr.DataArray], Any]:
    """The names of the flags of a verdict variable, as nested lists, read by CF alone."""

    def read(variable: xr.DataArray) -> Any:
        values = np.atleast_1d(variable.attrs["flag_values"]).tolist()
        names = dict(zip(values, variable.attrs["flag_meanings"].split(), strict=True))
        return np.vectorize(names.get, otypes=[object])(variable.values).tolist()

    return read
