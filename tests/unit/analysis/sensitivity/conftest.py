"""Functions with known indices, and samples of them as runs datasets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.methods.saltelli import REPLICATES
from impactlab.variables import described

A = np.array([0.0, 0.5, 3.0, 9.0, 99.0])
RESPONSES = ("peak_force", "impulse", "restitution")


@dataclass(frozen=True)
class Known:
    """A function with its first-order, total-order and second-order indices."""

    function: Callable[[Any], Any]
    first: Any
    total: Any
    second: Any
    bounds: tuple[float, float]

    @property
    def size(self):
        return len(self.first)

    def of_unit(self, unit):
        low, high = self.bounds
        return self.function(low + (high - low) * unit)


@pytest.fixture
def ishigami():
    """For a = 7, b = 0.1 (Ishigami and Homma 1990)."""

    def function(x):
        return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])

    v1 = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2
    v2, v13 = 49 / 8, 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
    second = np.zeros((3, 3))
    second[0, 2] = second[2, 0] = v13
    whole = v1 + v2 + v13
    first, total = np.array([v1, v2, 0]), np.array([v1 + v13, v2, v13])
    return Known(function, first / whole, total / whole, second / whole, (-np.pi, np.pi))


@pytest.fixture
def sobol_g():
    """Five parameters, from the most to the least important (Saltelli and Sobol' 1995)."""
    parts = 1 / (3 * (1 + A) ** 2)
    whole = np.prod(1 + parts) - 1
    total = parts * np.prod(1 + parts) / (1 + parts)

    def function(x):
        return np.prod((np.abs(4 * x - 2) + A) / (1 + A), axis=1)

    pairs = np.outer(parts, parts) / whole
    return Known(function, parts / whole, total / whole, pairs, (0.0, 1.0))


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
