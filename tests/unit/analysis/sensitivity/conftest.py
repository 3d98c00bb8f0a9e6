"""Functions with known indices, and samples of them as runs datasets."""

from collections.abc import Mapping, Sequence

import numpy as np
import pytest
import xarray as xr
from known_indices import INDICES, g

from impactlab.methods.saltelli import REPLICATES
from impactlab.variables import described

RESPONSES = ("peak_force", "impulse", "restitution")


@pytest.fixture
def ishigami():
    return INDICES["ishigami"]


@pytest.fixture
def sobol_g():
    """Five parameters, from the most to the least important."""
    return g(0.0, 0.5, 3.0, 9.0, 99.0)


@pytest.fixture
def drawn():
    """Runs of any method from inputs (runs, parameters) and outputs by response."""

    def build(method, inputs, outputs, **attrs):
        named = outputs if isinstance(outputs, Mapping) else {RESPONSES[0]: outputs}
        run = {"run": np.arange(len(inputs))}
        names: Sequence[str] = [f"x{i}" for i in range(inputs.shape[1])]
        arrays = {name: xr.DataArray(np.array(v, float), run) for name, v in named.items()}
        status = xr.DataArray(np.zeros(len(inputs), np.int32), run)
        ends = {"distribution": "uniform", "low": inputs.min(), "high": inputs.max()}
        columns = {name: ("run", inputs[:, i], ends) for i, name in enumerate(names)}
        given = {"study": "synthetic", "method": method, "varied": names, "seed": 1}
        given |= {"responses": list(named), "resamples": 100, "analyses": "sensitivity"}
        given |= {"replicates": REPLICATES} if method == "sobol" else {}
        return described(xr.Dataset({**arrays, "status": status}, run | columns, given | attrs))

    return build
