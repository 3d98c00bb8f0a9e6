"""The cost of a batch of runs beside its kernels, and the gain of a second thread: `make bench`.

The kernels alone, over a case table that is already there, run right before each timed
batch, and the ratios of these pairs are reported: what else the machine does then weighs on both.
Costs are compared in processor time. Throughput is compared in wall time, and only an idle machine
tells it: `cores`, processor over wall time of the batch, says how many it gave.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.section import fibre_table
from impactlab.solver.contact.history import CONTACT
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.kernels import kernel_of
from impactlab.solver.outputs import SERIES, blank
from impactlab.study.execute import solve_batch
from impactlab.study.solvers import kernels as impacts
from impactlab.study.store import OutputSpec, run_keys

RUNS = 1000
TASKS = 20
DURATIONS = (1e-3, 25e-3)
IMPACT = il.paper_impact()
GRID = il.Discretisation(nodes=101)
OUTPUT = OutputSpec(samples=0, profiles=False)
RANDOM = np.random.default_rng(1)
VARIED = {
    "velocity": RANDOM.uniform(0.5, 1.5, RUNS),
    "sphere_radius": RANDOM.uniform(0.03, 0.04, RUNS),
    "beam_yield_stress": RANDOM.uniform(300e6, 400e6, RUNS),
}


@dataclass(frozen=True)
class Line:
    """One line of the table; ratios: (pairs,); cores: that the batch had."""

    what: str
    ratios: np.ndarray
    target: str
    cores: float


def kernels(duration: float) -> Callable[[], object]:
    """The sum of the kernels: all that a batch has to compute."""
    cases = case_table(IMPACT, GRID, duration=duration, varied=VARIED)
    answers = blank(RUNS)
    nothing = np.zeros((RUNS, 0)), np.zeros((RUNS, 0, 0)), np.zeros((RUNS, 0, 0))
    samples = np.zeros((RUNS, 5, 0)), np.zeros((RUNS, 0, len(SERIES)))
    records = np.zeros(RUNS, CONTACT), np.zeros(RUNS, EVENTS)
    kernel = kernel_of(cases[0].beam_model, cases[0].scheme)
    tables = fibre_table(cases), np.empty((0, 0))
    return lambda: kernel(cases, *tables, answers, *records, *samples, *nothing)


def library(duration: float) -> Callable[[], object]:
    """The batch as the library gives it, labels, units and provenance included."""
    return lambda: il.simulate_many(IMPACT, GRID, duration=duration, varied=VARIED)


def study(duration: float, threads: int) -> Callable[[], object]:
    """The batch as a study solves it: table, keys, tasks; without dask and the disk."""

    def solved() -> object:
        cases = case_table(IMPACT, GRID, duration=duration, varied=VARIED)
        run_keys(cases, OUTPUT, impacts.SOLVER.version)
        with ThreadPoolExecutor(threads) as pool:
            under_way = [
                pool.submit(solve_batch, "impact", part, OUTPUT, impacts.SOLVER.version)
                for part in np.array_split(cases, TASKS)
            ]
            return [task.result() for task in under_way]

    return solved


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and processor time in s."""
    wall, processor = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - processor


def paired(first: Callable[[], object], second: Callable[[], object], pairs: int) -> np.ndarray:
    """Shape (2, 2, pairs): wall and processor time in s, of the first and of the second."""
    return np.array([(timed(first), timed(second)) for _ in range(pairs)]).T


def measured(duration: float, pairs: int) -> list[Line]:
    """The lines for batches of this duration."""
    alone, many = kernels(duration), library(duration)
    one, two = study(duration, threads=1), study(duration, threads=2)
    for warm_up in (alone, many, one, two):
        warm_up()
    lines = []
    for name, batch in (("simulate_many", many), ("a study's, one thread", one)):
        wall, processor = paired(alone, batch, pairs)
        cores = np.median(processor[1] / wall[1])
        what = f"{name}: cost in times the kernels'"
        lines.append(Line(what, processor[1] / processor[0], "<= 1.05", cores))
    wall, processor = paired(one, two, pairs)
    cores = np.median(processor[1] / wall[1])
    what = "a study's, two threads: throughput in times one's"
    return [*lines, Line(what, wall[0] / wall[1], ">= 1.90", cores)]


def main() -> int:
    """Print the table and write it as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=15)
    parser.add_argument("--output", type=Path, default=Path("results/benchmark_batch.csv"))
    options = parser.parse_args()
    title = f"{RUNS} runs of {GRID.nodes} nodes"
    table = Table("time", "batch", "min", "median", "max", "target", "cores", title=title)
    written = ["milliseconds,batch,ratio_min,ratio_median,ratio_max,target,cores"]
    for duration in DURATIONS:
        for line in measured(duration, options.pairs):
            numbers = [line.ratios.min(), np.median(line.ratios), line.ratios.max()]
            words = [*(f"{number:.3f}" for number in numbers), line.target, f"{line.cores:.2f}"]
            milliseconds = f"{1e3 * duration:g}"
            table.add_row(f"{milliseconds} ms", line.what, *words)
            written.append(",".join([milliseconds, f'"{line.what}"', *words]))
    Console().print(table)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text("\n".join(written) + "\n")
    print(f"Written to {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
