"""What a study costs beside its kernels, and what memory: `make scaling`, with --full a million.

Each line is a process of its own, so that its peak memory is its own. `short` and `long` (runs of
1 and 8 ms) compare processor time with that of the kernels alone, over cases that are there
already, measured right before and after: other programs weigh on wall time, hardly on this.
`throughput` (8 ms) is what two threads give in times one, in wall time: it wants an idle machine.
`runs_MB` is what runs.nc would take in memory.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.model.parameters import flatten
from impactlab.study.engine import Engine
from impactlab.study.execution import executed
from impactlab.study.netcdf import write_netcdf
from impactlab.study.solvers import impact
from impactlab.study.work import Work

SMALL = {"memory": (10_000, 100_000), "short": (3_000,), "long": (3_000,), "throughput": (3_000,)}
FULL = {
    "memory": (10_000, 1_000_000),
    "short": (100_000,),
    "long": (100_000,),
    "throughput": (100_000,),
}
NODES = {"memory": 11, "short": 101, "long": 101, "throughput": 101}
DURATION = {"memory": 1e-3, "short": 1e-3, "long": 8e-3, "throughput": 8e-3}
CHUNK = 1000


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


def kernels(work: Work) -> float:
    """Processor time of the kernels alone for all runs, in s, from a tenth of them."""
    spent, runs = 0.0, np.arange(0, work.size, 10)
    impact.solve(work.cases(runs[:1]), work.form)  # compiled, or loaded
    for at in range(0, runs.size, CHUNK):
        cases = work.cases(runs[at : at + CHUNK])
        start = time.process_time()
        impact.solve(cases, work.form)
        spent += time.process_time() - start
    return spent * work.size / runs.size


def measured(what: str, runs: int, threads: int) -> dict[str, object]:
    """One line of the table, in this process."""
    asked = design(runs, NODES[what], DURATION[what])
    line = {"what": what, "runs": runs, "nodes": NODES[what], "threads": threads}
    if alone := what in ("short", "long"):
        before = kernels(Work.of(asked))
    with tempfile.TemporaryDirectory() as folder:
        wall, processor = time.perf_counter(), time.process_time()
        with executed(asked, Path(folder), Engine(workers=threads)) as solved:
            write_netcdf(solved, Path(folder) / "runs.nc")
            line["runs_MB"] = solved.nbytes / 1e6
        line["wall_s"] = time.perf_counter() - wall
        line["processor_s"] = time.process_time() - processor
    line["peak_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    line["kernels_s"] = 0.5 * (before + kernels(Work.of(asked))) if alone else float("nan")
    return line


def apart(what: str, runs: int, threads: int) -> dict[str, object]:
    """One line of the table, measured in a process of its own."""
    command = [sys.executable, __file__, "--one", what, str(runs), str(threads)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def verdicts(lines: list[dict]) -> list[tuple[str, float, str]]:
    """What the lines say: (what, value, target)."""
    small, large, short, long, one, two = lines
    memory = large["peak_MB"] / small["peak_MB"]
    said = [("peak memory of the most runs in times the least", memory, "<= 1.5")]
    for line in (short, long):
        what = f"processor time in times the kernels', {line['what']} runs"
        said.append((what, line["processor_s"] / line["kernels_s"], "<= 1.05"))
    return [*said, ("two threads in times one", one["wall_s"] / two["wall_s"], ">= 1.9")]


def main() -> int:
    """Print the tables and write them as CSV."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="A million runs: some five minutes.")
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
        for what in ("memory", "short", "long", "throughput")
        for runs in sizes[what]
        for threads in {"memory": (2,), "throughput": (1, 2)}.get(what, (1,))
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
