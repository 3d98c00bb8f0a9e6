"""Samples drawn from distributions, and answered by closed forms in place of the solver."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from SALib.sample import sobol as sampler

import impactlab as il
from impactlab.analysis.surrogate.chaos import orthonormal
from impactlab.methods.distributions import distribution_of
from impactlab.variables import described

RANGES: dict[str, dict[str, Any]] = {
    "velocity": {"distribution": "uniform", "low": 5.0, "high": 15.0},
    "beam_depth": {"distribution": "uniform", "low": 0.026, "high": 0.029},
    "beam_yield_stress": {"distribution": "log_uniform", "low": 250e6, "high": 450e6},
}
Answer = Callable[[Any], Any]
UNIT = orthonormal(il.Uniform(0.0, 1.0))


@pytest.fixture(scope="session")
def drawn_runs():
    """Build Saltelli's runs of three parameters; answers: functions of the unit cube.

    With these ranges, the unit cube is linear in what the polynomials take.
    """

    def build(base_samples=64, seed=0, attrs=None, ranges=RANGES, **answers):
        problem = {"num_vars": 3, "names": list(ranges), "bounds": [[0, 1]] * 3}
        unit = sampler.sample(problem, base_samples, calc_second_order=True, seed=7)
        unit = np.clip(unit, 2.0**-31, 1 - 2.0**-31)
        run = xr.Dataset(coords={"run": np.arange(len(unit)), "gravity": 9.81})
        variables: dict[str, Any] = {name: ("run", f(unit)) for name, f in answers.items()}
        variables["status"] = ("run", np.zeros(len(unit), np.int32))
        coords = {
            name: ("run", distribution_of(given).quantile(unit[:, at]), given)
            for at, (name, given) in enumerate(ranges.items())
        }
        own = {
            "study": "synthetic",
            "method": "sobol",
            "varied": list(ranges),
            "responses": list(answers),
            "base_samples": base_samples,
            "seed": seed,
            "confidence": 0.95,
        }
        attributes = own | dict(attrs or {})
        return described(run.assign(variables).assign_coords(coords).assign_attrs(attributes))

    return build
