"""Cost and error of each scheme in time: `make bench`.

Elastic: root mean square error of the force history over its peak, against the modal series.
Yielding: against leapfrog with 3201 nodes. The two schemes are timed in turns, on the same core,
and the ratios of these pairs are reported: what else the machine does then weighs on both.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.cost import node_steps
from impactlab.simulate import case_table, solve
from impactlab.solver import SCHEMES
from impactlab.verification.cases import elastic
from impactlab.verification.solutions import modal

DURATION = 1e-3
SAMPLES = 401
NODES = (101, 201, 401, 601, 801, 1201, 1601)
FINE = 3201
NODE_STEPS = 5e6
"""At least this many in a timing."""

Errors = Callable[[xr.Dataset], dict[str, float]]


@dataclass(frozen=True)
class Line:
    """One line of the table. seconds: (pairs,), of processor time per run."""

    scheme: str
    nodes: int
    node_steps: float
    seconds: np.ndarray
    ratio: float
    errors: dict[str, float]

    def words(self) -> list[str]:
        """Numbers as they are told; ratio: leapfrog's time over the semi-implicit scheme's."""
        median = float(np.median(self.seconds))
        cost = [f"{1e3 * median:.3f}", f"{1e9 * median / self.node_steps:.2f}"]
        cost.append(f"{self.ratio:.2f}" if self.scheme != SCHEMES[0] else "")
        return [self.scheme, str(self.nodes), *cost]


def against_series(impact: il.Impact) -> Errors:
    """Errors of elastic runs."""
    series = modal.solve(impact, DURATION)

    def errors(run: xr.Dataset) -> dict[str, float]:
        force = series.at("contact_force", run.time.values)
        gap = run.contact_force.values - force
        return {
            "force history": float(np.sqrt(np.mean(gap**2)) / force.max()),
            "peak force": abs(run.peak_force.item() / series.peak_force - 1.0),
            "contact duration": abs(run.contact_duration.item() / series.contact_duration - 1.0),
        }

    return errors


def against_fine(impact: il.Impact) -> Errors:
    """Errors of yielding runs."""
    fine = simulate(impact, "leapfrog", FINE)

    def errors(run: xr.Dataset) -> dict[str, float]:
        gap = run.contact_force.values - fine.contact_force.values
        found = {"force history": float(np.sqrt(np.mean(gap**2)) / fine.peak_force.item())}
        for name in ("peak_force", "contact_duration", "plastic_dissipation"):
            found[name.replace("_", " ")] = abs(run[name].item() / fine[name].item() - 1.0)
        return found

    return errors


def simulate(impact: il.Impact, scheme: str, nodes: int) -> xr.Dataset:
    """One run with its histories."""
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    return il.simulate(impact, grid, duration=DURATION, samples=SAMPLES)


def timed(impact: il.Impact, scheme: str, nodes: int) -> tuple[Callable[[], float], float]:
    """A function that tells a run's seconds of processor time; the run's node-steps."""
    grid = il.Discretisation(nodes=nodes, scheme=scheme)
    cases = case_table(impact, grid, duration=DURATION)
    cost = float(node_steps(cases[0]))
    cases = np.repeat(cases, math.ceil(NODE_STEPS / cost))
    solve(cases[:1])  # compiles

    def seconds() -> float:
        start = time.thread_time()
        solve(cases)
        return (time.thread_time() - start) / cases.size

    return seconds, cost


def measured(impact: il.Impact, errors: Errors, pairs: int) -> Iterator[Line]:
    """Two lines for each number of nodes."""
    for nodes in NODES:
        runs = {scheme: timed(impact, scheme, nodes) for scheme in SCHEMES}
        seconds = np.array([[run() for run, _ in runs.values()] for _ in range(pairs)])
        ratio = float(np.median(seconds[:, 0] / seconds[:, 1]))
        for at, (scheme, (_, cost)) in enumerate(runs.items()):
            found = errors(simulate(impact, scheme, nodes))
            yield Line(scheme, nodes, cost, seconds[:, at], ratio, found)


def main() -> int:
    """Print the tables and write them as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--output", type=Path, default=Path("results/benchmark_schemes.csv"))
    options = parser.parse_args()
    unyielding, yielding = elastic(il.paper_impact()), il.paper_impact(15.0)
    cases = {
        "elastic, 0.99 m/s": (unyielding, against_series(unyielding)),
        "yielding, 15 m/s": (yielding, against_fine(yielding)),
    }
    columns = ["scheme", "nodes", "ms", "ns per node-step", "times faster"]
    written = ["case,scheme,nodes,milliseconds,ns_a_node_step,times_faster,quantity,error"]
    for name, (impact, errors) in cases.items():
        lines = list(measured(impact, errors, options.pairs))
        quantities = [f"error of {quantity}" for quantity in lines[0].errors]
        table = Table(*columns, *quantities, title=name)
        for line in lines:
            table.add_row(*line.words(), *(f"{error:.1e}" for error in line.errors.values()))
            for quantity, error in line.errors.items():
                row = [f'"{name}"', *line.words(), quantity, f"{error:.3e}"]
                written.append(",".join(row))
        Console(width=120).print(table)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text("\n".join(written) + "\n")
    print(f"Written to {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
