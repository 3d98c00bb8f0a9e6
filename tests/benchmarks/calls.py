"""The cost of `il.simulate` and `il.simulate_many` beside their kernels: `make bench`.

The kernels alone, over a case table that is already there, run right before each timed call on the
same thread, and differences and ratios of these pairs are reported: what else the machine does then
weighs on both. "same axes": only the velocity changes from run to run; "other axes": the span does,
too. What a study costs beside its kernels, and what a second thread brings: scaling.py.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import solve

PAPER, DURATION, SAMPLES = il.paper_impact(), 10e-3, 2001
RUNS, DURATIONS = 1000, (1e-3, 25e-3)
RANDOM = np.random.default_rng(1)
VARIED = {
    "velocity": RANDOM.uniform(0.5, 1.5, RUNS),
    "sphere_radius": RANDOM.uniform(0.03, 0.04, RUNS),
    "beam_yield_stress": RANDOM.uniform(300e6, 400e6, RUNS),
}


def seconds(work: Callable[[], object]) -> float:
    """Processor time in s."""
    start = time.process_time()
    work()
    return time.process_time() - start


def single(growth: float, pairs: int) -> Iterator[tuple[float, float]]:
    """Processor times in s of the kernel's part of a run, and of all of it."""
    grid = il.Discretisation(nodes=101, scheme="modal")
    for k in range(pairs):
        beam = replace(PAPER.beam, span=PAPER.beam.span + growth * k)
        impact = replace(PAPER, beam=beam, velocity=1.0 + 1e-6 * k)
        cases = case_table(impact, grid, duration=DURATION)
        alone = seconds(lambda cases=cases: solve(cases, samples=SAMPLES, profiles=True))
        yield (
            alone,
            seconds(
                lambda impact=impact: il.simulate(impact, grid, duration=DURATION, samples=SAMPLES)
            ),
        )


def batch(duration: float, pairs: int) -> Iterator[tuple[float, float]]:
    """Processor times in s of the kernels of a batch, and of the batch with labels and units."""
    grid = il.Discretisation(nodes=101)
    cases = case_table(PAPER, grid, duration=duration, varied=VARIED)
    for _ in range(pairs):
        alone = seconds(lambda: solve(cases))
        yield (
            alone,
            seconds(lambda: il.simulate_many(PAPER, grid, duration=duration, varied=VARIED)),
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=300)
    options = parser.parse_args()
    table = Table("calls", "beside the kernels, ms: min", "median", "ratio, median", "target")
    lines = {
        "a run, same axes": (single(0.0, options.pairs), "1 ms"),
        "a run, other axes": (single(1e-6, options.pairs), ""),
    }
    for duration in DURATIONS:
        name = f"{RUNS} runs of {1e3 * duration:g} ms"
        lines[name] = batch(duration, 2 + options.pairs // 20), "ratio 1.05"
    for name, (pairs, target) in lines.items():
        alone, whole = np.array(list(pairs)[1:]).T
        beside = 1e3 * (whole - alone)
        numbers = beside.min(), np.median(beside), np.median(whole / alone)
        table.add_row(name, *(f"{number:.2f}" for number in numbers), target)
    Console().print(table)


if __name__ == "__main__":
    main()
