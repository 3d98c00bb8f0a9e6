"""Error against processor time of each scheme in time: `make bench`, and docs/schemes.png.

The paper's sphere and beam over 4 ms, which hold the largest deflection and later sub-impacts. The
reference is the modal scheme with 801 nodes; what leapfrog with 2401 differs by is its own error.
Beside them: Timoshenko's beam against a fine run of its own; elastic runs against the modal series,
and the series, a program in NumPy, against a finer one; and, where the extra `opensees` is
installed, OpenSees given the force history of the reference: deflection and dissipation.

A time is the least of several, of a batch of equal runs on one thread; all take turns.
"""

from __future__ import annotations

import argparse
import functools
import math
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

import impactlab as il
from impactlab.figures import style
from impactlab.model.case_table import case_table
from impactlab.solve import compile_kernels, solve
from impactlab.verification.cases import elastic
from impactlab.verification.solutions import hertz, modal

ROOT = Path(__file__).parents[2]
DURATION = 4e-3
VELOCITIES = (0.99, 5.0, 10.0, 15.0)
RESPONSES = [
    "peak_force",
    "contact_duration",
    "maximum_indentation",
    "maximum_deflection",
    "plastic_dissipation",
]
FEW = (31, 41, 51, 61, 75, 101, 125, 151, 201, 251, 301, 401)
NODES = {
    "modal": (7, 9, 11, 13, 17, 21, 25, *FEW),
    "leapfrog": (*FEW, 501, 601, 801),
    "timoshenko": FEW,
}
FINE = {"modal": 801, "leapfrog": 2401, "timoshenko": 1601}
SERIES = ((4, 30), (6, 60), (10, 120), (20, 250), (50, 500))
"""Modes, and steps per contact of Hertz on a half-space."""
OPENSEES = ((5, 250), (10, 500), (10, 1000), (20, 2000), (40, 4000), (80, 4000))
"""Elements and steps."""
NAMES = {
    "modal": "modal",
    "leapfrog": "leapfrog",
    "timoshenko": "leapfrog, Timoshenko's beam",
    "series": "modal series in NumPy, elastic beam",
    "opensees": "OpenSees, force given (two responses)",
}
LABELLED = {"modal": (9, 101, 401), "leapfrog": (31, 801)}
"""Nodes written beside their points."""
LEAST_SECONDS = 0.02
"""Of a timing."""

Run = Callable[[int], np.ndarray]
"""Solve so many copies of a run (the kernels alone), and return the RESPONSES of one."""


@functools.cache
def table(impact: il.Impact, scheme: str, nodes: int) -> np.ndarray:
    """The case of a run."""
    if scheme == "timoshenko":
        impact, scheme = replace(impact, beam_model="timoshenko"), "leapfrog"
    return case_table(impact, il.Discretisation(nodes=nodes, scheme=scheme), duration=DURATION)


def kernel(impact: il.Impact, scheme: str, nodes: int, copies: int = 1) -> np.ndarray:
    """Our solver."""
    answers = solve(np.repeat(table(impact, scheme, nodes), copies))
    return np.array([answers[name][0] for name in RESPONSES])


def series(impact: il.Impact, modes: int, steps: int, _: int = 1) -> np.ndarray:
    """The modal series."""
    step = hertz.contact_duration(*hertz.arguments(impact)) / steps
    run = modal.solve(impact, DURATION, modes=modes, step=step)
    often = np.linspace(0.0, DURATION, 20001)
    largest = [run.at(name, often).max() for name in ("indentation", "midspan_deflection")]
    return np.array([run.peak_force, run.contact_duration, *largest, 0.0])


def opensees(
    impact: il.Impact, force: np.ndarray, elements: int, steps: int, _: int = 1
) -> np.ndarray:
    """OpenSees under a force history."""
    from opensees_beam import strike

    return np.array([np.nan] * 3 + [*strike(impact.beam, force, DURATION, elements, steps)])


def measured(runs: dict[tuple[str, int, int], Run], rounds: int) -> pd.DataFrame:
    """Responses and milliseconds per run; a row per solver, size of its grid, and steps."""
    seconds, copies, answers = {}, {}, []
    for key, run in runs.items():
        answers.append(run(1))
        copies[key], seconds[key] = 1, math.inf
        start = time.thread_time()
        while key[0] in NODES and time.thread_time() - start < LEAST_SECONDS:
            copies[key] *= 2
            run(copies[key])
    for _ in range(rounds):
        for key, run in runs.items():
            start = time.thread_time()
            run(copies[key])
            seconds[key] = min(seconds[key], (time.thread_time() - start) / copies[key])
    index = pd.MultiIndex.from_tuples(runs, names=["solver", "size", "steps"])
    return pd.DataFrame(answers, index, RESPONSES).assign(ms=1e3 * np.array([*seconds.values()]))


def errors(found: pd.DataFrame, exact: dict[str, np.ndarray]) -> pd.DataFrame:
    """Errors in the place of responses, and the worst of them; a response of zero has none."""
    solvers = found.index.get_level_values("solver")
    of_each = np.array([exact.get(solver, exact["modal"]) for solver in solvers])
    off = (found[RESPONSES] / np.where(of_each > 0.0, of_each, np.nan) - 1.0).abs()
    return off.assign(worst=off.max(axis=1), ms=found.ms)


def of_velocity(velocity: float, rounds: int) -> tuple[pd.DataFrame, float]:
    """Errors and times at a velocity, elastic runs beneath; the error of the reference."""
    impact = il.paper_impact(velocity)
    exact = {scheme: kernel(impact, scheme, nodes) for scheme, nodes in FINE.items()}
    with np.errstate(invalid="ignore"):
        doubt = float(np.nanmax(np.abs(exact.pop("leapfrog") / exact["modal"] - 1.0)))
    runs: dict[tuple[str, int, int], Run] = {}
    for scheme, numbers in NODES.items():
        runs |= {(scheme, n, 0): partial(kernel, impact, scheme, n) for n in numbers}
    if find_spec("openseespy"):
        fine = il.Discretisation(nodes=FINE["modal"], scheme="modal")
        histories = il.simulate(impact, fine, duration=DURATION, samples=20001)
        force = histories.contact_force.values
        runs |= {("opensees", *grid): partial(opensees, impact, force, *grid) for grid in OPENSEES}
    paper = errors(measured(runs, rounds), exact)

    impact = elastic(impact)
    runs = {("series", *grid): partial(series, impact, *grid) for grid in SERIES}
    for scheme in ("modal", "leapfrog"):
        runs |= {(scheme, n, 0): partial(kernel, impact, scheme, n) for n in NODES[scheme]}
    free = errors(measured(runs, rounds), {"modal": series(impact, 200, 2000)})
    return pd.concat({"paper": paper, "elastic": free}, names=["case"]), doubt


def cheapest(rows: pd.DataFrame, tolerance: float) -> tuple[float, str]:
    """Milliseconds for a tolerance, or NaN, and these words with the size of the grid.

    The grid is the coarsest that is within the tolerance, as all finer ones are. The time is
    interpolated, in logarithms, between it and the next coarser one: "<=" where there is none.
    """
    worst_of_finer = np.maximum.accumulate(rows.worst.to_numpy()[::-1])
    count = int(np.sum(worst_of_finer <= tolerance))
    if count == 0:
        return math.nan, ""
    log_ms = np.log(rows.ms.to_numpy()[::-1])
    ms = math.exp(np.interp(math.log(tolerance), np.log(worst_of_finer), log_ms))
    size = rows.index.get_level_values("size")[-count]
    return ms, f"{'<= ' if count == len(rows) else ''}{ms:.2g} ({size})"


def costs(found: pd.DataFrame) -> Table:
    """The time for 1 % and for 0.1 % of all responses, and leapfrog's over the modal scheme's."""
    table = Table("case", "m/s", "error", *NAMES.values(), "ratio", title="ms per run (size)")
    for (case, velocity), rows in found.groupby(level=["case", "velocity"], sort=False):
        for tolerance in (1e-2, 1e-3):
            each = rows.groupby(level="solver")
            best = {solver: cheapest(grids, tolerance) for solver, grids in each}
            told = [best.get(solver, (0.0, ""))[1] for solver in NAMES]
            ratio = f"{best['leapfrog'][0] / best['modal'][0]:.1f}"
            table.add_row(case, f"{velocity:g}", f"{tolerance:.1%}", *told, ratio)
    return table


@style.paper
def drawn(found: pd.DataFrame, doubts: dict[float, float]) -> Figure:
    """Worst error of the responses against processor time, a panel per velocity."""
    figure, axes = style.panels(len(VELOCITIES), columns=2, height=62, sharex=True, sharey=True)
    for ax, velocity in zip(axes, VELOCITIES, strict=True):
        ax.axhspan(1e-9, 100.0 * doubts[velocity], color="0.9", label="error of the reference")
        ax.set_title(f"{velocity:g} m/s", loc="left")
        for at, (solver, name) in enumerate(NAMES.items()):
            case, colour = "elastic" if solver == "series" else "paper", style.COLOURS[at]
            rows = found.query(
                f"velocity == {velocity} and case == {case!r} and solver == {solver!r}"
            )
            if rows.empty:
                continue
            look = {"linestyle": style.LINES[at > 1], "marker": style.MARKERS[at], "label": name}
            ax.loglog(rows.ms, 100.0 * rows.worst, color=colour, **look)
            offset = (-2, -8) if solver == "modal" else (3, 3)
            for (*_, nodes, _), row in rows.iterrows():
                if nodes in LABELLED.get(solver, ()):
                    where = (row.ms, 100.0 * row.worst)
                    look = {"color": colour, "fontsize": 7, "ha": "right" if at == 0 else "left"}
                    ax.annotate(f"{nodes}", where, offset, textcoords="offset points", **look)
    axes[0].set_ylim(5e-4, 100.0)
    figure.supxlabel("processor time per run, ms")
    figure.supylabel("worst error of the responses, %")
    style.legend(figure, order=[*NAMES.values(), "error of the reference"])
    return figure


def main() -> int:
    """Print the table, and write CSV and picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "benchmark_schemes.csv")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "schemes.png")
    options = parser.parse_args()
    compile_kernels(extended=[False])
    each = {velocity: of_velocity(velocity, options.rounds) for velocity in VELOCITIES}
    found = pd.concat({velocity: rows for velocity, (rows, _) in each.items()}, names=["velocity"])
    doubts = {velocity: doubt for velocity, (_, doubt) in each.items()}
    Console(width=160).print(costs(found))
    print("error of the reference:", ", ".join(f"{v:g} m/s {d:.1e}" for v, d in doubts.items()))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    found.to_csv(options.output, float_format="%.4g")
    drawn(found, doubts).savefig(options.figure)
    print(f"Written to {options.output} and {options.figure}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
