"""Coverage of 80 % posterior intervals with fitted surrogates, and modes of bimodal posteriors.

    python tests/benchmarks/calibration_coverage.py [SEEDS]

The surrogate of each seed is fitted to 120 draws of a closed form that no polynomial follows; the
measurements scatter by its error on runs held out, the least uncertainty that is accepted.
"""

from __future__ import annotations

import json
import sys

import numpy as np
import scipy.special
import scipy.stats
import xarray as xr

from impactlab.analysis import surrogate
from impactlab.analysis.importance import posterior
from impactlab.analysis.likelihood import Likelihood
from impactlab.analysis.measurements import Measurement
from impactlab.analysis.surrogate.stored import Surrogate

UNIFORM = {"distribution": "uniform", "low": 0.0, "high": 1.0, "units": "1"}
FUNCTIONS = {
    "kink": lambda a, v: np.maximum(v - 0.6 * a, 0) + 0.5 * a * (1 + v),
    "wave": lambda a, v: 2 * a + np.sin(6 * a * v + 1) + 0.5 * v**2,
    "root": lambda a, v: (0.3 + a) ** 0.5 * (0.2 + v) ** 1.2 + 0.2 * np.exp(-3 * a * v),
}


def fitted(function, seed):
    a, v, idle = scipy.stats.qmc.LatinHypercube(3, rng=np.random.default_rng(seed)).random(120).T
    columns = {"a": a, "v": v, "idle": idle}
    coordinates = {name: ("run", column, UNIFORM) for name, column in columns.items()}
    value = ("run", function(a, v), {"units": "1", "long_name": "value"})
    runs = xr.Dataset(
        {"value": value, "status": ("run", np.zeros(120, np.int32))},
        {"run": np.arange(120), **coordinates},
        {"study": "coverage", "method": "pawn", "samples": 120, "seed": seed}
        | {"varied": list(columns), "responses": ["value"]},
    )
    return Surrogate(surrogate.packed(runs, surrogate.analysis(runs)))


def rank(function, model, seed, places):
    """Return the posterior probability of values below the truth."""
    rng = np.random.default_rng(seed)
    truth, start = rng.uniform(0.15, 0.85), rng.uniform(0.15, 0.8)
    error = float(model.dataset["rmse"].item())
    data = [
        Measurement("value", y, 1.001 * error, "1", {"v": v, "idle": 0.5}, "made")
        for v in start + places
        for y in [float(function(truth, v)) + rng.normal(0, error)]
    ]
    matched = Likelihood(model, data, {}, 0.0)
    found = posterior(matched.log, 1, seed, last=4000)
    return float(found.weights[matched.values(found.points)[:, 0] < truth].sum())


def bimodal(parameters, deviations, share, seed):
    """Return the weight of the mode at 0.2, of 0.2 and 0.8 on all axes."""

    def log_density(points):
        rows = [
            np.log(part) + scipy.stats.norm(place, width).logpdf(points).sum(axis=1)
            for place, width, part in zip((0.2, 0.8), deviations, (share, 1 - share), strict=True)
        ]
        return scipy.special.logsumexp(rows, axis=0)

    found = posterior(log_density, parameters, seed)
    return found.weights[found.points[:, 0] < 0.5].sum()


if __name__ == "__main__":
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for name, function in FUNCTIONS.items():
        models, ranks = [], {}
        for seed in range(seeds):
            try:
                models.append((seed, fitted(function, seed)))
            except ValueError as error:
                print(name, seed, error)
        for count, spread in ((1, 0.0), (3, 0.05), (10, 0.05), (10, 0.2)):
            places = np.linspace(-spread, spread, count) / 2 if count > 1 else np.zeros(1)
            values = []
            for seed, model in models:
                try:
                    values.append(rank(function, model, seed, places))
                except ValueError:  # a surrogate that is not usable
                    continue
            inside = np.mean(np.abs(np.array(values) - 0.5) < 0.4)
            ranks[f"{count} within {spread:g}"] = f"{inside:.2f} of {len(values)}"
        print(name, json.dumps(ranks), flush=True)
    for parameters in (1, 2, 5):
        for deviations, share in (((0.02, 0.02), 0.5), ((0.05, 0.01), 0.5), ((0.03, 0.01), 0.95)):
            shares = [bimodal(parameters, deviations, share, seed) for seed in range(seeds // 10)]
            print(parameters, deviations, share, np.min(shares).round(3), np.max(shares).round(3))
