"""Estimated over measured processor time of runs, by beam model, scheme, nodes and duration.

    python tests/benchmarks/cost.py

Each line is of runs of the paper's sphere and beam at velocities from 0.5 to 20 m/s, after one
batch for the compiler. The estimate is `work` of model/cost.py and what any run costs beside it, by
which studies are priced. The ratio depends on the machine, by the same factor in all lines.
"""

from dataclasses import replace
from time import process_time

import numpy as np

from impactlab.model.case_table import case_table
from impactlab.model.cost import A_SECOND, ANY_RUN, work
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.solve import solve

CASES = [
    *(("euler_bernoulli", "leapfrog", nodes, ms) for nodes in (21, 51, 101, 201) for ms in (1, 12)),
    *(("euler_bernoulli", "modal", nodes, ms) for nodes in (21, 51, 101, 201) for ms in (1, 12)),
    *(("elastic", scheme, 101, 12) for scheme in ("leapfrog", "modal")),
    *(("timoshenko", "leapfrog", nodes, 12) for nodes in (51, 101, 201)),
    *(("von_karman", "leapfrog", nodes, 12) for nodes in (21, 51, 101)),
    *((model, "leapfrog", 101, 12) for model in ("spring_mass", "rigid")),
]
"""Beam model, scheme, nodes and milliseconds."""
VELOCITIES = {"slow": (0.5, 2.0), "fast": (5.0, 20.0)}  # m/s


def cases(model, scheme, nodes, duration, velocities, number):
    """Return the case table of so many runs at velocities spread evenly between two."""
    impact = replace(paper_impact(), beam_model=model)
    grid = Discretisation(nodes=nodes, scheme=scheme)
    varied = {"velocity": np.linspace(*velocities, number)}
    return case_table(impact, grid, duration=duration, varied=varied)


def measured(table):
    """Return the least processor time per run of three batches, in s."""
    times = []
    for _ in range(3):
        start = process_time()
        solve(table)
        times.append((process_time() - start) / table.size)
    return min(times)


def main():
    """Print one line per case, and the least and largest ratio."""
    ratios = []
    print("model            scheme    nodes     ms  velocity  measured, ms  estimated  ratio")
    for model, scheme, nodes, ms in CASES:
        for label, velocities in VELOCITIES.items():
            few = cases(model, scheme, nodes, 1e-3 * ms, velocities, 4)
            expected = float(np.mean(work(few) + ANY_RUN)) / A_SECOND
            number = int(np.clip(0.3 / expected, 4, 2000))
            table = cases(model, scheme, nodes, 1e-3 * ms, velocities, number)
            solve(few)
            taken = measured(table)
            told = float(np.mean(work(table) + ANY_RUN)) / A_SECOND
            ratios.append(told / taken)
            print(
                f"{model:16s} {scheme:9s} {nodes:5d} {ms:6d}  {label:8s} {1e3 * taken:13.4g} "
                f"{1e3 * told:10.4g} {ratios[-1]:6.2f}",
                flush=True,
            )
    print(f"estimated over measured: {min(ratios):.2f} to {max(ratios):.2f}")


if __name__ == "__main__":
    main()
