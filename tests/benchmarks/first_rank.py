"""Share of small tables whose answer names a first input, and of those that name a wrong one.

`python tests/benchmarks/first_rank.py delta 64 160`: one row per function and number of rows, with
the shares of 200 seeds; tables whose intervals are narrow count as without a name. Where two inputs
are equal, either is wrong.
"""

import argparse
from collections.abc import Sequence

import numpy as np
import xarray as xr
from functions import Case, g, linear, names

import impactlab as il
from impactlab.analysis import sensitivity
from impactlab.methods import INDICES
from impactlab.report.ranking import first_ranks
from impactlab.study.table import GIVEN_DATA


def steps(*heights: float) -> Case:
    """Return a sum of steps in the middle of the range."""
    parts = {(i,): height**2 / 4 for i, height in enumerate(heights)}
    return Case(names(len(heights)), lambda x: (x > 0.5) @ np.array(heights), parts)


def bumps(*heights: float) -> Case:
    """Return a sum of waves, which no straight line describes."""
    parts = {(i,): height**2 / 2 for i, height in enumerate(heights)}
    waves = np.array(heights)
    return Case(names(len(heights)), lambda x: np.cos(2 * np.pi * x) @ waves, parts)


CASES: dict[str, tuple[Case, float, Sequence[int]]] = {
    "two equal": (linear(1, 1, 0.5), 0.0, ()),
    "two equal, noise": (linear(1, 1, 0.3, 0, 0), 0.2, ()),
    "two equal, interacting": (g(0, 0, 4.5, 9), 0.0, ()),
    "two equal steps": (steps(1, 1, 0.2, 0.1), 0.05, ()),
    "two equal waves": (bumps(1, 1, 0.5), 0.0, ()),
    "six equal": (linear(*[1.0] * 6), 0.0, ()),
    "noise alone": (linear(*[1e-3] * 4), 1.0, ()),
    "nearly equal": (linear(1, 0.9, 0.5), 0.0, (0,)),
    "twice the slope": (linear(2, 1, 0.5, 0.2), 0.0, (0,)),
    "interacting": (g(0, 1, 4.5, 9, 99, 99), 0.0, (0,)),
    "dominant": (linear(3, 1, 0.5, 0.2), 0.0, (0,)),
    "dominant, noise": (linear(1, 0.3, 0.1, 0), 0.1, (0,)),
    "dominant wave": (bumps(3, 1, 0.5), 0.0, (0,)),
}
"""A function, the standard deviation of noise beside it, and its first parameter."""


def table(method: str, rows: int, case: Case, noise: float, seed: int) -> xr.Dataset:
    """Return the runs of one table."""
    rng, parameters = np.random.default_rng(seed + 1), len(case.groups)
    unit = rng.random((rows, parameters))
    outputs = case.function(unit) + noise * rng.standard_normal(rows)
    columns = dict(zip(case.groups, unit.T, strict=True))
    runs = il.runs_of_table(columns, {"value": outputs}, indices=method, seed=seed)
    return runs.assign_attrs(resamples=50)


def main() -> None:
    """Print one row per function and number of rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("method", choices=GIVEN_DATA)
    parser.add_argument("rows", type=int, nargs="+")
    parser.add_argument("--seeds", type=int, default=200)
    options = parser.parse_args()
    family = INDICES[options.method].family
    for title, (case, noise, first) in CASES.items():
        for rows in options.rows:
            named = wrong = 0
            for seed in range(options.seeds):
                runs = table(options.method, rows, case, noise, seed)
                texts = first_ranks(runs, sensitivity.analysis(runs), family, ["value"])
                for text in texts.values():
                    named += 1
                    wrong += text.partition(" ")[0] not in [case.groups[i] for i in first]
            shares = f"named {named / options.seeds:7.1%}, wrong {wrong / options.seeds:6.1%}"
            print(f"{options.method:10} {title:24} {rows:5}: {shares}", flush=True)


if __name__ == "__main__":
    main()
