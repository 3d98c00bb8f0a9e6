"""The cost of a study beside its kernels, and its memory: `make scaling`, with --full a million.

Each line is a process of its own, so that its peak memory is its own. `short` and `long` (runs of
1 and 8 ms) compare its processor time with what its own threads spent in the kernels: both in one
process, for a machine's speed may change by a third from one minute to the next. `long` is also
solved with two threads, between two times with one: what they give in times one is a ratio of wall
times, and wants an idle machine of one speed; how many threads are busy in kernels does not want
the latter. `runs_MB` is what runs.nc would take in memory.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.files import write_netcdf
from impactlab.model.parameters import flatten
from impactlab.study.engine import Engine
from impactlab.study.execute import open_runs
from impactlab.study.netcdf import Columns
from impactlab.study.solvers import impact
from impactlab.study.store import OutputSpec

KINDS = {"memory": (11, 1e-3), "short": (101, 1e-3), "long": (101, 8e-3)}
"""Nodes and duration, in s."""
SMALL = {"memory": (10_000, 100_000), "short": (3_000,), "long": (3_000,)}
FULL = {"memory": (10_000, 1_000_000), "short": (100_000,), "long": (100_000,)}
THREADS = {"memory": (2,), "short": (1,), "long": (1, 2, 2, 1)}
"""Of the lines, in their order; what drifts weighs on one as on two."""


def design(runs: int, nodes: int, duration: float) -> xr.Dataset:
    """A sample in three parameters, all responses asked for."""
    random = np.random.default_rng(1)
    fixed = flatten(il.paper_impact(), il.Discretisation(nodes=nodes)) | {"duration": duration}
    varied = {
        "velocity": random.uniform(0.5, 1.5, runs),
        "sphere_radius": random.uniform(0.03, 0.04, runs),
        "beam_yield_stress": random.uniform(300e6, 400e6, runs),
    }
    attrs = {"study": "scaling", "varied": [*varied], "responses": [*il.dataset.RESPONSES]}
    attrs |= {"histories": 0, "profiles": 0, "history_samples": 2}
    fixed |= {name: ("run", values) for name, values in varied.items()}
    return xr.Dataset(coords=fixed, attrs=attrs)


@contextmanager
def kernels() -> Iterator[list[float]]:
    """Within, the processor time of each batch in the kernels, in s, by the thread that took it."""
    spent: list[float] = []

    def timed(cases: np.ndarray[Any, Any], output: OutputSpec) -> Columns:
        start = time.thread_time()
        columns = whole.solve(cases, output)
        spent.append(time.thread_time() - start)
        return columns

    whole, impact.SOLVER = impact.SOLVER, replace(impact.SOLVER, solve=timed)
    try:
        yield spent
    finally:
        impact.SOLVER = whole


def measured(what: str, runs: int, threads: int) -> dict[str, object]:
    """One line of the table, in this process."""
    asked = design(runs, *KINDS[what])
    line = {"what": what, "runs": runs, "threads": threads}
    impact.SOLVER.solve(
        impact.cases(asked, np.arange(1)), OutputSpec.of(asked)
    )  # compiled, or loaded
    with tempfile.TemporaryDirectory() as folder, kernels() as spent:
        wall, processor = time.perf_counter(), time.process_time()
        with open_runs(asked, Path(folder), Engine(workers=threads)) as solved:
            write_netcdf(solved, Path(folder) / "runs.nc", "runs")
            line["runs_MB"] = solved.nbytes / 1e6
        line["wall_s"] = time.perf_counter() - wall
        line["processor_s"] = time.process_time() - processor
    line["kernels_s"] = sum(spent)
    line["peak_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    return line


def apart(what: str, runs: int, threads: int) -> dict[str, object]:
    """One line of the table, measured in a process of its own."""
    command = [sys.executable, __file__, "--one", what, str(runs), str(threads)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def verdicts(lines: list[dict]) -> list[tuple[str, float, str]]:
    """Return the lines as (what, value, target)."""
    small, large, short, one, two, two_again, one_again = lines
    memory = large["peak_MB"] / small["peak_MB"]
    said = [("peak memory of the most runs in times the least", memory, "<= 1.5")]
    for line in (short, one):
        what = f"processor time in times the kernels', {line['what']} runs"
        said.append((what, line["processor_s"] / line["kernels_s"], "<= 1.05"))
    told = "two threads in times one"
    once, twice = (one, one_again), (two, two_again)
    said.append((f"{told}, wall", _all(once, "wall_s") / _all(twice, "wall_s"), ">= 1.9"))
    busy = [_all(lines, "kernels_s") / _all(lines, "wall_s") for lines in (once, twice)]
    return [*said, (f"{told}, threads busy in kernels", busy[1] / busy[0], ">= 1.9")]


def _all(lines: Iterable[dict], name: str) -> float:
    return sum(line[name] for line in lines)


def main() -> int:
    """Print the tables and write them as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="A million runs: eight to ten minutes.")
    parser.add_argument("--output", type=Path, default=Path("results/benchmark_scaling.csv"))
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        what, runs, threads = options.one
        print(json.dumps(measured(what, int(runs), int(threads))))
        return 0
    sizes = FULL if options.full else SMALL
    apart("memory", 100, 1)  # the kernels are compiled, where they are not yet
    lines = [
        apart(what, runs, threads)
        for what, counts in sizes.items()
        for runs in counts
        for threads in THREADS[what]
    ]
    table = Table(*lines[0])
    for line in lines:
        table.add_row(*(f"{v:,.1f}" if isinstance(v, float) else f"{v}" for v in line.values()))
    told = Table("ratio", "value", "target")
    for what, value, target in verdicts(lines):
        told.add_row(what, f"{value:.3f}", target)
    Console().print(table, told)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    rows = [",".join(lines[0]), *(",".join(map(str, line.values())) for line in lines)]
    options.output.write_text("\n".join(rows) + "\n")
    print(f"Written to {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
