"""Coverage of the intervals of Sobol indices where a surrogate supplies the values of failed runs.

    python tests/benchmarks/imputation_coverage.py [SEEDS [BASE_SAMPLES]]

One row per function and kind of failure: samples that are refused, and, over the others, the share
of seeds whose interval holds the exact first and total orders, by parameter. Takes 0.1 s per seed.
"""

from __future__ import annotations

import sys

import numpy as np
import xarray as xr
from functions import ishigami, names

from impactlab.analysis.sensitivity.indices import imputed
from impactlab.methods import sobol
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import REPLICATES, saltelli

SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 200
BASE = int(sys.argv[2]) if len(sys.argv) > 2 else 64
NAMES = names(3)
UNIFORM = {"distribution": "uniform", "low": 0.0, "high": 1.0}
ORDERS = ("first_order", "total_order")
FUNCTIONS = {
    "Ishigami": ishigami(*NAMES).function,
    "wave": lambda x: x[:, 0] + 0.6 * x[:, 1] + 0.15 * np.sin(9 * x[:, 0] * (1 + x[:, 1])),
    "smooth": lambda x: np.sin(3 * x[:, 0]) + x[:, 1] * x[:, 2],
    "kink": lambda x: np.maximum(x[:, 0] - 0.6 * x[:, 1], 0) + 0.3 * x[:, 2],
}
FAILURES = {
    "2 % anywhere": lambda x, rng: rng.random(len(x)) < 0.02,
    "15 % anywhere": lambda x, rng: rng.random(len(x)) < 0.15,
    "x0 above 0.92": lambda x, rng: x[:, 0] > 0.92,
    "x0 + x1 above 1.6": lambda x, rng: x[:, 0] + x[:, 1] > 1.6,
    "half of x0 above 0.8": lambda x, rng: (x[:, 0] > 0.8) & (rng.random(len(x)) < 0.5),
}


def estimated(points, outputs, base_samples, seed):
    """Return indices and half-widths; None where the imputation is refused."""
    attrs = {"varied": NAMES, "method": "sobol", "base_samples": base_samples, "second_order": 0}
    attrs |= {"replicates": REPLICATES, "seed": seed, "failed_runs": "impute", "responses": ["y"]}
    columns = {name: ("run", points[:, i], UNIFORM) for i, name in enumerate(NAMES)}
    sample = Sample.of(xr.Dataset(coords={"run": np.arange(len(points))} | columns, attrs=attrs))
    supplied = imputed(outputs, sample, "y")
    if supplied.refusal is not None:
        return None
    indices = sobol.INDICES.estimate(supplied.outputs, sample, "y")
    margins = [indices[f"{order}_interval"] + supplied.half_width for order in ORDERS]
    return np.array([indices[order] for order in ORDERS]), np.array(margins)


def main():
    """Print the rows."""
    many = saltelli(NAMES, 2**16, False, 0)
    for name, function in FUNCTIONS.items():
        exact, _ = estimated(many, function(many), 2**16, 0)
        for kind, failure in FAILURES.items():
            hits = []
            for seed in range(SEEDS):
                points = saltelli(NAMES, BASE, False, seed)
                failed = failure(points, np.random.default_rng(seed))
                outputs = np.where(failed, np.nan, function(points))
                if (answer := estimated(points, outputs, BASE, seed)) is not None:
                    hits.append(np.abs(answer[0] - exact) <= answer[1] + 1e-6)
            covered = np.mean(hits, axis=0).round(2).tolist() if hits else ""
            print(f"{name:8} {kind:20} {SEEDS - len(hits)} refused, held {covered}", flush=True)


if __name__ == "__main__":
    main()
