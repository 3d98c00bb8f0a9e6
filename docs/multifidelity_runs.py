"""Plain 3-D runs under the tolerances of studies/sobol.yaml, appended to multifidelity_runs.csv.

They are what estimates of two fidelities are held against. Run `python docs/multifidelity_runs.py
RUNS`: runs are solved one after the other, and those of the file are not repeated.
"""

from __future__ import annotations

import csv
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats

import impactlab as il
from impactlab.fem3d.solver import solve
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.model.discretisation import Discretisation
from impactlab.model.parameters import with_values

FILE = Path(__file__).with_suffix(".csv")
DURATION = 0.2e-3  # s; the indentation is largest after 0.1 ms
ELEMENTS_PER_RADIUS = 2.0
PARAMETERS = {
    "beam_yield_stress": stats.truncnorm(-3.0, 3.0, 345e6, 25e6),
    "beam_youngs_modulus": stats.triang(0.5, 190e9, 40e9),
    "beam_depth": stats.uniform(26.4e-3, 2.8e-3),
    "beam_width": stats.uniform(57e-3, 6e-3),
    "beam_span": stats.uniform(760e-3, 40e-3),
    "beam_density": stats.uniform(7700.0, 200.0),
    "sphere_radius": stats.uniform(33e-3, 4e-3),
    "beam_isotropic_hardening_modulus": stats.uniform(0.0, 3e9),
}
"""Distributions of studies/sobol.yaml in SI units."""


def parameters(runs: int, seed: int) -> dict[str, np.ndarray]:
    """Return independent draws by name, (runs,); the first of a longer sample are the same."""
    points = np.random.default_rng(seed).random((runs, len(PARAMETERS)))
    return {
        name: spread.ppf(column)
        for (name, spread), column in zip(PARAMETERS.items(), points.T, strict=True)
    }


def main(runs: int) -> None:
    """Solve and append what the file lacks of the first runs."""
    columns = parameters(runs, seed=1)
    done = len(FILE.read_text().splitlines()) - 1 if FILE.exists() else 0
    with FILE.open("a", newline="") as file:
        rows = csv.writer(file)
        if not done:
            rows.writerow([*columns, "maximum_indentation", "seconds"])
        for run in range(done, runs):
            values = {name: float(column[run]) for name, column in columns.items()}
            plain = replace(il.paper_impact("5 m/s"), beam_model="solid")
            impact, _ = with_values(plain, Discretisation(), values)
            size = contact_radius(impact) / ELEMENTS_PER_RADIUS
            begun = time.process_time()
            try:
                answers = solve(impact, element_size=size, duration=DURATION, samples=2)
                dent = float(answers["maximum_indentation"])
            except ValueError:
                dent = np.nan
            seconds = round(time.process_time() - begun, 3)
            rows.writerow([*(f"{value:.9g}" for value in values.values()), repr(dent), seconds])
            file.flush()


if __name__ == "__main__":
    main(int(sys.argv[1]))
