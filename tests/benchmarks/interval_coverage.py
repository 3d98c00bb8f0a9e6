"""Coverage of the intervals of one method on functions with known indices.

`python tests/benchmarks/interval_coverage.py fast 1476 2952 --seeds 200`: one row per function,
number of samples and index, with the share of seeds in which the interval of each parameter holds
the exact index, among all and among those whose verdict is usable.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from functions import Case, g, ishigami, linear, names

import impactlab as il
from impactlab.analysis import sensitivity
from impactlab.types import Floats
from impactlab.variables import described

A = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0, 99.0, 99.0])
WEIGHTS = np.array([4.0, 2.0, 1.0, 0.5])


FUNCTIONS: dict[str, Callable[[int], Case]] = {
    "ishigami": lambda size: ishigami(*names(size)),
    "g": lambda size: g(*A[:size]),
    "linear": lambda size: linear(*WEIGHTS[: size - 1], *[0.0] * max(size - 4, 1)),
}
"""By the number of parameters, of which those that the function leaves out are inert."""


def distribution_indices(name: str, size: int) -> tuple[Floats, Floats, Floats]:
    """Return delta, and median and largest PAWN over ten slides, from six million runs.

    Noise has made delta too large by up to 0.01 near zero, where that of an inert parameter is 0.
    """
    rng, shape = np.random.default_rng(5), (60, 120)
    function = FUNCTIONS[name](size).function
    edges = np.quantile(function(rng.random((500_000, size))), np.arange(1, 120) / 120)
    counts = np.zeros((size, *shape))
    for _ in range(6):
        unit = rng.random((1_000_000, size))
        bins = np.searchsorted(edges, function(unit))
        for parameter, column in enumerate(unit.T):
            cells = (column * shape[0]).astype(int) * shape[1] + bins
            counts[parameter] += np.bincount(cells, minlength=shape[0] * shape[1]).reshape(shape)
    joint = counts / counts.sum(axis=(1, 2), keepdims=True)
    apart = joint - joint.sum(axis=1, keepdims=True) * joint.sum(axis=2, keepdims=True)
    slides = joint.reshape(size, 10, 6, -1).sum(axis=2) * 10
    steps = np.cumsum(slides - joint.sum(axis=1)[:, None], axis=2)
    distances = np.abs(steps).max(axis=2)
    inert = distances.max(axis=1) < 0.004
    measures = np.abs(apart).sum(axis=(1, 2)) / 2, np.median(distances, 1), distances.max(axis=1)
    return tuple(np.where(inert, 0.0, measure) for measure in measures)  # type: ignore[return-value]


def indices_of(function: str, sampling: Any, resamples: int) -> xr.Dataset:
    """Return the analysis of one sample, without its surrogate."""
    design = il.Study(title="-", function="g", sampling=sampling).design()
    unit = np.column_stack([design[name] for name in sampling.parameters])
    attrs = {"responses": ["value"], "resamples": resamples}
    runs = {
        "value": ("run", FUNCTIONS[function](unit.shape[1]).function(unit)),
        "status": ("run", np.zeros(len(unit), int)),
    }
    return sensitivity.analysis(described(design.assign(runs).assign_attrs(attrs)))


def main() -> None:
    """Print one row per function, number of samples and index."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("method", choices=["fast", "delta", "pawn"])
    parser.add_argument("samples", type=int, nargs="+")
    parser.add_argument("--parameters", type=int, default=4)
    parser.add_argument("--harmonics", type=int, default=4)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--resamples", type=int, default=40)
    args = parser.parse_args()
    parameters = {f"x{number + 1}": il.Uniform(0, 1) for number in range(args.parameters)}
    method = {"fast": il.Fast, "delta": il.Delta, "pawn": il.Pawn}[args.method]
    options = {"harmonics": args.harmonics} if args.method == "fast" else {}
    for function in FUNCTIONS:
        exact = FUNCTIONS[function](args.parameters).exact()
        del exact["second_order"]
        if args.method != "fast":
            delta, median, maximum = distribution_indices(function, args.parameters)
            exact = {"delta": delta, "delta_first_order": exact["first_order"]}
            if args.method == "pawn":
                exact = {"pawn": median, "pawn_maximum": maximum}
        for samples in args.samples:
            samplings = (
                method(samples=samples, seed=seed, parameters=parameters, **options)
                for seed in range(args.seeds)
            )
            analyses = [indices_of(function, each, args.resamples) for each in samplings]
            indices = xr.concat(analyses, "seed").isel(response=0)
            usable = (indices["sensitivity_verdict"] == 0).values
            for name, values in exact.items():
                margins = indices[f"{name}_interval"].values
                held = np.abs(indices[name].values - values) <= margins
                among = held[usable].mean(axis=0).round(2) if usable.any() else "-"
                widths = margins.mean(axis=0).round(3)
                print(
                    f"{function:9} {samples:5} {name:18} held {held.mean(axis=0).round(2)}, "
                    f"of {usable.mean():.0%} usable {among}, half-width {widths}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
