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
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import dask
import dask.array as da
import numpy as np
import xarray as xr
from dask.delayed import delayed
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.files import opened, write_netcdf
from impactlab.model.parameters import flatten
from impactlab.study.engine import Engine
from impactlab.study.execute import open_runs
from impactlab.study.shard import Columns
from impactlab.study.solvers import kernels as impacts
from impactlab.study.store import OutputSpec
from impactlab.variables import RESPONSES, described

KINDS = {"memory": (11, 1e-3), "short": (101, 1e-3), "long": (101, 8e-3)}
"""Nodes and duration, in s."""
SMALL = {"memory": (10_000, 100_000), "short": (3_000,), "long": (3_000,)}
FULL = {"memory": (10_000, 1_000_000), "short": (1_000_000,), "long": (100_000,)}
ANALYSED = {False: 1_000_000, True: 150_000_000}
"""Runs of the sample that is analysed, in full or not."""
_PROGRAM, _COLUMNS = 2e9, 2.5
"""Its limit of address space: bytes, and columns of 8 bytes per run."""
THREADS = {"memory": (2,), "short": (2,), "long": (1, 2, 2, 1)}
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
    attrs = {"study": "scaling", "varied": [*varied], "responses": [*RESPONSES]}
    attrs |= {"histories": 0, "profiles": 0, "history_samples": 2}
    fixed |= {name: ("run", values) for name, values in varied.items()}
    return xr.Dataset(coords=fixed, attrs=attrs)


SAMPLED = (
    *("velocity", "sphere_radius", "beam_yield_stress", "beam_youngs_modulus"),
    *("beam_depth", "beam_width", "beam_span", "beam_density"),
)
ANSWERED = "peak_force", "impulse", "maximum_deflection"
"""Parameters and responses of the sample that is analysed."""


def weights(response: int) -> np.ndarray[Any, Any]:
    """The weights of the parameters in a response, whose Sobol indices are w^2 / sum(w^2)."""
    return np.roll(np.arange(1.0, len(SAMPLED) + 1), response)


def write_sample(path: Path, runs: int) -> None:
    """Write runs.nc of a Saltelli sample in which responses are sums of the parameters."""
    step = len(SAMPLED) + 2

    def inputs(at: int) -> np.ndarray[Any, Any]:
        first, second = np.random.default_rng(at).random((2, runs // step, 1))
        table = np.repeat(first, step, axis=1)
        table[:, [at + 1, -1]] = second
        return table.ravel()

    def outputs(at: int) -> np.ndarray[Any, Any]:
        total = np.zeros(runs)
        for parameter, weight in enumerate(weights(at)):
            total += weight * inputs(parameter)
        return total

    def column(make: Callable[[int], Any], at: int, **attrs: Any) -> tuple[str, Any, Any]:
        return "run", da.from_delayed(delayed(make)(at), (runs,), float), attrs

    known = {"distribution": "uniform", "low": 0.0, "high": 1.0}
    coords = {name: column(inputs, at, **known) for at, name in enumerate(SAMPLED)}
    answers = {name: column(outputs, at) for at, name in enumerate(ANSWERED)}
    attrs = {"study": "scaling", "method": "sobol", "varied": SAMPLED, "responses": ANSWERED}
    attrs |= {"base_samples": runs // step, "second_order": 0, "seed": 1}
    answers["status"] = "run", da.zeros(runs, dtype=np.int32, chunks=-1)
    coords["run"] = "run", np.arange(runs)
    with dask.config.set(scheduler="synchronous"):  # a column at a time
        write_netcdf(described(xr.Dataset(answers, coords, attrs)), path, "runs")


def analysed(runs: int) -> dict[str, object]:
    """The line of the analysis: `impactlab analyse` in an address space too small for the runs."""
    limit = int(_PROGRAM + _COLUMNS * 8 * runs)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "runs.nc"
        subprocess.run([sys.executable, __file__, "--write", str(path), str(runs)], check=True)
        start, command = time.perf_counter(), [sys.executable, "-m", "impactlab", "analyse"]
        limited = partial(resource.setrlimit, resource.RLIMIT_AS, (limit, limit))
        process = subprocess.Popen([*command, str(path)], preexec_fn=limited)
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        if status:
            raise RuntimeError(f"the analysis of {runs} runs failed within {limit / 1e6:.0f} MB")
        with opened(path) as stored, opened(path.with_name("analysis.nc")) as found:
            size = stored.nbytes
            exact = np.array([weights(at) ** 2 for at in range(len(ANSWERED))])
            exact /= exact.sum(axis=1, keepdims=True)
            away = [np.abs(found[f"{name}_order"] - exact).max() for name in ("first", "total")]
    return {
        "runs": runs,
        "runs_MB": size / 1e6,
        "limit_MB": limit / 1e6,
        "peak_MB": used.ru_maxrss / 1e3,
        "wall_s": wall,
        "processor_s": used.ru_utime + used.ru_stime,
        "largest_error_of_indices": float(max(away)),
    }


@contextmanager
def kernels() -> Iterator[list[float]]:
    """Within, the processor time of each batch in the kernels, in s, by the thread that took it."""
    spent: list[float] = []

    def timed(cases: np.ndarray[Any, Any], output: OutputSpec) -> Columns:
        start = time.thread_time()
        columns = whole.solve(cases, output)
        spent.append(time.thread_time() - start)
        return columns

    whole, impacts.SOLVER = impacts.SOLVER, replace(impacts.SOLVER, solve=timed)
    try:
        yield spent
    finally:
        impacts.SOLVER = whole


def measured(what: str, runs: int, threads: int) -> dict[str, object]:
    """One line of the table, in this process."""
    asked = design(runs, *KINDS[what])
    line = {"what": what, "runs": runs, "threads": threads}
    impacts.SOLVER.solve(
        impacts.cases(asked, np.arange(1)), OutputSpec.of(asked)
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


def _table(lines: list[dict]) -> Table:
    table = Table(*lines[0])
    for line in lines:
        table.add_row(*(f"{v:,.4g}" if isinstance(v, float) else f"{v:,}" for v in line.values()))
    return table


def main() -> int:
    """Print the tables and write them as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--full",
        action="store_true",
        help="A million runs, and 150 million to analyse: half an hour.",
    )
    parser.add_argument("--output", type=Path, default=Path("results/benchmark_scaling.csv"))
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    parser.add_argument("--analysis", type=int, help="Only the analysis, of so many runs.")
    parser.add_argument("--write", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        what, runs, threads = options.one
        print(json.dumps(measured(what, int(runs), int(threads))))
        return 0
    if options.write:
        write_sample(Path(options.write[0]), int(options.write[1]))
        return 0
    if options.analysis:
        Console().print(_table([analysed(options.analysis)]))
        return 0
    sizes = FULL if options.full else SMALL
    apart("memory", 100, 1)  # the kernels are compiled, where they are not yet
    lines = [
        apart(what, runs, threads)
        for what, counts in sizes.items()
        for runs in counts
        for threads in THREADS[what]
    ]
    told = Table("ratio", "value", "target")
    for what, value, target in verdicts(lines):
        told.add_row(what, f"{value:.3f}", target)
    Console().print(_table(lines), told, _table([analysed(ANALYSED[options.full])]))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    rows = [",".join(lines[0]), *(",".join(map(str, line.values())) for line in lines)]
    options.output.write_text("\n".join(rows) + "\n")
    print(f"Written to {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
