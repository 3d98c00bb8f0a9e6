"""The cost of `il.simulate` beside its kernel: `make bench`.

The part of the kernel (`solve` with histories and profiles) runs right before each timed call on
the same thread, and differences and ratios of these pairs are reported: what else the machine does
then weighs on both. "same axes": only the velocity changes from run to run; "other axes": the span
does, too.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import solve

GRID = il.Discretisation(nodes=101, scheme="modal")
DURATION = 10e-3
SAMPLES = 2001


def seconds(work: Callable[[], object]) -> float:
    """Processor time in s."""
    start = time.thread_time()
    work()
    return time.thread_time() - start


def pair(impact: il.Impact) -> tuple[float, float]:
    """Processor times in s of the kernel's part, and of all of it."""
    cases = case_table(impact, GRID, duration=DURATION)
    alone = seconds(lambda: solve(cases, samples=SAMPLES, profiles=True))
    return alone, seconds(lambda: il.simulate(impact, GRID, duration=DURATION, samples=SAMPLES))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=300)
    options = parser.parse_args()
    paper = il.paper_impact()
    table = Table("runs", "beside the kernel, ms: min", "median", "ratio, median", "target, ms")
    for name, growth, target in (("same axes", 0.0, "1"), ("other axes", 1e-6, "")):
        pairs = []
        for k in range(options.pairs):
            beam = replace(paper.beam, span=paper.beam.span + growth * k)
            pairs.append(pair(replace(paper, beam=beam, velocity=1.0 + 1e-6 * k)))
        alone, whole = np.array(pairs[1:]).T
        beside = 1e3 * (whole - alone)
        numbers = beside.min(), np.median(beside), np.median(whole / alone)
        table.add_row(name, *(f"{number:.2f}" for number in numbers), target)
    Console().print(table)


if __name__ == "__main__":
    main()
