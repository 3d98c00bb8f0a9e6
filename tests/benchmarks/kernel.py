"""The cost of the kernel in multiples of an elastic C stencil: `make bench`.

The yardstick runs right before each timed run of the kernel, on the same core, and the ratios of
these pairs are reported: what else the machine does then weighs on both.
"""

from __future__ import annotations

import argparse
import math
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.cost import node_steps
from impactlab.solve import solve

DURATION = 1e-3
NODE_STEPS = 1e7
"""At least this many in a timing."""
FLAGS = ("-O3", "-march=native", "-ffast-math")
WIDER = "-mprefer-vector-width=512"


@dataclass(frozen=True)
class Case:
    """One line of the table; target: the ratio to stay below."""

    name: str
    velocity: float
    nodes: int
    points: int
    hardening: float
    target: float


CASES = (
    Case("601 nodes, 0.99 m/s, elastic", 0.99, 601, 9, 0.0, 1.3),
    Case("601 nodes, 9 points, 15 m/s", 15.0, 601, 9, 0.0, 2.0),
    Case("601 nodes, 21 points, 20 m/s", 20.0, 601, 21, 0.0, 3.0),
    Case("601 nodes, 21 points, 20 m/s, hardening", 20.0, 601, 21, 2e9, 3.0),
    Case("101 nodes, 0.99 m/s, elastic", 0.99, 101, 9, 0.0, 2.5),
)


def stencils(folder: Path) -> list[Path]:
    """The yardstick, compiled in both ways; none without gcc."""
    if shutil.which("gcc") is None:
        return []
    built = []
    for name, flags in {"native": FLAGS, "wider": (*FLAGS, WIDER)}.items():
        program = folder / name
        source = Path(__file__).with_name("elastic_stencil.c")
        subprocess.run(["gcc", *flags, source, "-o", program, "-lm"], check=True)
        built.append(program)
    return built


def yardstick(programs: list[Path], nodes: int, steps: int) -> float:
    """Seconds a node-step of the faster program."""
    half = nodes // 2

    def seconds(program: Path) -> float:
        said = subprocess.run([program, str(half), str(steps)], capture_output=True, check=True)
        return float(said.stdout.split()[0]) / (half * steps)

    return min(map(seconds, programs))


def kernel(case: Case) -> tuple[Callable[[], float], int]:
    """Return a function that solves the case and returns seconds per node-step; the steps."""
    grid = il.Discretisation(nodes=case.nodes, points=case.points)
    cases = case_table(
        il.paper_impact(case.velocity),
        grid,
        duration=DURATION,
        varied={"beam_isotropic_hardening_modulus": [case.hardening]},
    )
    # short cases many times over: a timing of a tenth of a millisecond tells of cold caches
    cases = np.repeat(cases, math.ceil(NODE_STEPS / node_steps(cases[0])))
    cost = cases.size * node_steps(cases[0])
    solve(cases)  # compiles

    def seconds() -> float:
        start = time.thread_time()
        solve(cases)
        return (time.thread_time() - start) / cost

    return seconds, int(2 * cost / case.nodes)


def measured(case: Case, programs: list[Path], pairs: int) -> tuple[np.ndarray, np.ndarray]:
    """Seconds a node-step of kernel and yardstick, (pairs,) each."""
    run, steps = kernel(case)
    both = [(yardstick(programs, case.nodes, steps), run()) for _ in range(pairs)]
    stencil, ours = np.array(both).T
    return ours, stencil


def main() -> int:
    """Print the table and write it as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=15)
    parser.add_argument("--output", type=Path, default=Path("results/benchmarks.csv"))
    options = parser.parse_args()
    table = Table("case", "ns per node-step", "C", "ratio min", "median", "max", "target")
    lines = ["case,kernel_ns,stencil_ns,ratio_min,ratio_median,ratio_max,target"]
    with tempfile.TemporaryDirectory() as folder:
        programs = stencils(Path(folder))
        if not programs:
            print("gcc is not here, so there is no yardstick: nothing measured", file=sys.stderr)
            return 1
        for case in CASES:
            ours, stencil = measured(case, programs, options.pairs)
            ratio = ours / stencil
            numbers = [1e9 * np.median(ours), 1e9 * np.median(stencil)]
            numbers += [ratio.min(), np.median(ratio), ratio.max(), case.target]
            words = [f"{number:.2f}" for number in numbers]
            table.add_row(case.name, *words)
            lines.append(",".join([f'"{case.name}"', *words]))
    Console().print(table)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text("\n".join(lines) + "\n")
    print(f"Written to {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
