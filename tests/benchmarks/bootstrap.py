"""The cost of the intervals of Sobol indices: `make bench`.

Against SALib's own bootstrap where that is bearable, and at the full size: 10 responses of 10
parameters, 8192 base samples with second order, 1000 resamples.
"""

from __future__ import annotations

import resource
import time

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table
from SALib.analyze import sobol as salib

from impactlab.analysis import sensitivity

SMALL = (1, 8, 2048, 200)
FULL = (10, 10, 8192, 1000)
"""Responses, parameters, base samples, resamples."""


def sample(responses: int, parameters: int, base_samples: int, resamples: int) -> xr.Dataset:
    """Made-up runs: what the outputs are does not matter to the time."""
    number = base_samples * (2 * parameters + 2)
    values = np.random.default_rng(1).normal(size=(responses, number))
    names = [f"x{i}" for i in range(parameters)]
    attrs = {
        "method": "sobol",
        "varied": names,
        "responses": [f"y{i}" for i in range(responses)],
        "base_samples": base_samples,
        "second_order": 1,
        "seed": 1,
        "confidence": 0.95,
        "resamples": resamples,
    }
    outputs = {f"y{i}": ("run", row) for i, row in enumerate(values)}
    status = {"status": ("run", np.zeros(number, np.int32))}
    coords = {name: ("run", np.zeros(number)) for name in names}
    return xr.Dataset(outputs | status, coords | {"run": np.arange(number)}, attrs)


def ours(runs: xr.Dataset) -> float:
    """Seconds of the whole analysis, nested samples included."""
    start = time.perf_counter()
    sensitivity.analysis(runs)
    return time.perf_counter() - start


def theirs(runs: xr.Dataset) -> float:
    """Seconds of SALib's, without nested samples."""
    names = [str(name) for name in runs.attrs["varied"]]
    problem = {"num_vars": len(names), "names": names}
    start = time.perf_counter()
    for name in runs.attrs["responses"]:
        salib.analyze(problem, runs[name].values, num_resamples=runs.attrs["resamples"], seed=1)
    return time.perf_counter() - start


def main() -> None:
    """Print the table."""
    table = Table("responses", "parameters", "base samples", "resamples", "seconds", "SALib's")
    for size in (SMALL, FULL):
        runs = sample(*size)
        before = _memory()
        seconds = ours(runs)
        ratio = f"{theirs(runs) / seconds:.0f} times as long" if size == SMALL else ""
        table.add_row(*(str(number) for number in size), f"{seconds:.2f}", ratio)
    Console().print(table)
    print(f"largest memory beside the runs: {_memory() - before:.0f} MB")


def _memory() -> float:
    """The largest so far, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
