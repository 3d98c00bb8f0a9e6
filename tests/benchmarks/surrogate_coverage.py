"""Coverage of the 95 % intervals of surrogates' predictions along the axes of the parameters.

    python tests/benchmarks/surrogate_coverage.py [SURROGATES [RUNS]]

Each surrogate is fitted to a Latin hypercube of the parameters of studies/sobol.yaml. One parameter
then takes 21 values over its range, the others their medians. One row per response, of the solver
on a coarse grid and of two formulas: coverage at all of these points, by parameter, and in the
middle. Takes 2 s per surrogate.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import scipy.stats
import xarray as xr
from ruamel.yaml import YAML

import impactlab as il
from impactlab.analysis import surrogate
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.methods.distributions import distribution_of
from impactlab.model.case_table import case_table
from impactlab.solve import solve

NUMBER = int(sys.argv[1]) if len(sys.argv) > 1 else 200
RUNS = int(sys.argv[2]) if len(sys.argv) > 2 else 400
POINTS = 21
STUDY = YAML(typ="safe").load(Path(__file__).parents[2] / "studies/sobol.yaml")
DESIGN = il.Study(**STUDY | {"discretisation": None}).design()
NAMES = list(DESIGN.attrs["varied"])
DISTRIBUTIONS = [distribution_of(DESIGN[name].attrs) for name in NAMES]
SOLVED = ["peak_force", "contact_duration", "maximum_indentation", "maximum_deflection"]


def inputs(unit):
    """Return the parameters in SI units where they have these probabilities."""
    pairs = zip(DISTRIBUTIONS, unit.T, strict=True)
    return np.column_stack([distribution.quantile(column) for distribution, column in pairs])


def responses(points):
    """Return the solver's responses, and those of two formulas, one smooth, one with kinks."""
    grid = il.Discretisation(nodes=37, points=5, courant=0.9, scheme="modal")
    varied = dict(zip(NAMES, points.T, strict=True))
    solved = solve(case_table(il.paper_impact("5 m/s"), grid, duration=0.003, varied=varied))
    z = ((points - MEDIANS) / SPREADS).T
    return {name: solved[name] for name in SOLVED} | {
        "smooth": np.exp(0.3 * z[0]) * (1 + 0.1 * z[1]) + np.arctan(z[2]) + 0.2 * z[3] * z[6],
        "kinks": z[0] + 0.5 * z[6] + 0.5 * np.abs(z[0] + 0.3 * z[1] - 1) + 0.1 * z[2] ** 2,
    }


MEDIANS, LOW, HIGH = (inputs(np.full((1, len(NAMES)), p))[0] for p in (0.5, 0.16, 0.84))
SPREADS = (HIGH - LOW) / 2


def fitted(seed):
    """Return the surrogates of one sample."""
    points = inputs(scipy.stats.qmc.LatinHypercube(len(NAMES), rng=seed).random(RUNS))
    values = responses(points)
    variables = {n: ("run", v.astype(float), {"units": "1"}) for n, v in values.items()}
    columns = {n: ("run", points[:, i], DESIGN[n].attrs) for i, n in enumerate(NAMES)}
    attrs = {"study": "coverage", "method": "pawn", "samples": RUNS, "seed": seed}
    runs = xr.Dataset(
        variables | {"status": ("run", np.zeros(RUNS, np.int32))},
        {"run": np.arange(RUNS)} | columns,
        attrs | {"varied": NAMES, "responses": list(values)},
    )
    return Surrogate(surrogate.packed(runs, surrogate.analysis(runs)))


def main():
    """Print one row per response."""
    axes = np.full((len(NAMES), POINTS, len(NAMES)), 0.5)
    for i, distribution in enumerate(DISTRIBUTIONS):
        values = np.linspace(*distribution.bounds().values(), POINTS)
        axes[i, :, i] = distribution.cumulative(values)
    unit = axes.reshape(-1, len(NAMES))
    exact = responses(inputs(unit))
    hits = {name: [] for name in exact}
    for seed in range(NUMBER):
        model = fitted(seed)
        predicted, errors = model.at(unit), model.errors(unit)
        for row, (name, values) in enumerate(exact.items()):
            if int(model.dataset["verdict"][row]) == 0:
                held = np.abs(predicted[row] - values) <= errors[row]
                hits[name].append(held.reshape(len(NAMES), POINTS))
    for name, held in hits.items():
        coverage = np.mean(held, axis=0)
        by_parameter = " ".join(f"{share:.2f}" for share in coverage.mean(axis=1))
        middle = coverage[:, POINTS // 2].mean()
        print(f"{name:20} {len(held)} usable: {coverage.mean():.3f}, {by_parameter}, {middle:.2f}")


if __name__ == "__main__":
    main()
