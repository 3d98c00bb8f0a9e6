"""Coverage of the intervals of Sobol indices, and rates of their verdicts: `make bench`.

Each function has known parts of its variance. A row tells, for first, total and second order, the
share of seeds whose interval holds the exact index (the worst parameter or pair), the root mean
square of the error and the median half-width (both of the widest), and how often each verdict
holds. The last rows tell how often the intervals hold that made `until` stop.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import xarray as xr
from functions import Case, g, ishigami, linear, names
from rich.console import Console
from rich.table import Table

from impactlab.methods import sobol
from impactlab.methods.record import SensitivityVerdict
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import REPLICATES, saltelli

SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 200
SIZES = (16, 64, 256, 1024, 2048)
LIMIT = 0.05
"""The interval at which `until` stops."""
ORDERS = ("first_order", "total_order", "second_order")
VERDICTS = ("WIDE_INTERVALS", "INCONSISTENT", "DEPENDENT_BASES")


def pair(count: int, i: int, j: int, slope: float = 0.0) -> Case:
    """Return two parameters' product, plus their sum times a slope."""
    parts = {(i,): slope**2 / 12, (j,): slope**2 / 12, (i, j): 9 / 144}
    return Case(
        names(count),
        lambda x: slope * (x[:, i] + x[:, j]) + 3 * (x[:, i] - 0.5) * (x[:, j] - 0.5),
        parts,
    )


def step(count: int, threshold: float) -> Case:
    """Return 1 where two parameters exceed a threshold, and 1/2 where a third exceeds 1/2."""
    above = 1 - threshold
    alone = above**3 * threshold
    both = above**2 * (1 - above**2) - 2 * alone
    return Case(
        names(count),
        lambda x: 1.0 * (x[:, :2] > threshold).all(axis=1) + 0.5 * (x[:, 2] > 0.5),
        {(0,): alone, (1,): alone, (0, 1): both, (2,): 1 / 16},
    )


CASES = {
    "sum and product x0, x3 of 6": pair(6, 0, 3, 1.0),
    "product x0, x3 of 6": pair(6, 0, 3),
    "product x0, x1 of 5": pair(5, 0, 1),
    "product x0, x1 of 4": pair(4, 0, 1),
    "product x2, x5 of 8": pair(8, 2, 5),
    "product x1, x7 of 10": pair(10, 1, 7),
    "product of 2": pair(2, 0, 1),
    "Ishigami": ishigami("x0", "x1", "x2"),
    "Ishigami, grouped": ishigami("one", "other", "one"),
    "G of 5": g(0.0, 0.5, 3.0, 9.0, 99.0),
    "linear in 2": linear(2, 1),
    "linear in 4, one inert": linear(3, 2, 1, 0),
    "linear in 10": linear(*range(1, 11)),
    "step at 0.53": step(4, 0.53),
    "step at 0.8": step(4, 0.8),
}


def estimated(case: Case, size: int, outputs: Any) -> dict[str, Any]:
    """Return the indices and half-widths on the first base samples."""
    attrs = {"varied": list(case.groups), "groups": list(case.groups), "base_samples": size}
    attrs |= {"second_order": 1, "replicates": REPLICATES}
    part = outputs[: size * (2 * len(set(case.groups)) + 2)]
    runs = xr.Dataset(coords={"run": np.arange(part.size)}, attrs=attrs)
    found = sobol.INDICES.estimate(part, Sample.of(runs), "y")
    for name in ("second_order", "second_order_interval"):
        found[name] = found[name][np.triu_indices(len(found[name]), 1)]
    return found


def main() -> None:
    """Print the tables."""
    table = Table("function", "base samples", "coverage", "error", "half-width", *VERDICTS)
    stopped = Table("function", f"seeds that reach {LIMIT}", "coverage then", "base samples then")
    for name, case in CASES.items():
        exact = case.exact()
        held: list[Any] = []
        stops: list[int] = []
        samples = [case.function(saltelli(case.groups, SIZES[-1], True, s)) for s in range(SEEDS)]
        for size in SIZES:
            seeds = [estimated(case, size, outputs) for outputs in samples]
            cells: list[list[str]] = [[], [], []]
            for order in ORDERS:
                errors = np.array([found[order] for found in seeds]) - exact[order]
                margins = np.array([found[f"{order}_interval"] for found in seeds])
                cells[0].append(f"{(abs(errors) <= margins + 1e-9).mean(axis=0).min():.2f}")
                cells[1].append(f"{np.sqrt((errors**2).mean(axis=0)).max():.3f}")
                cells[2].append(f"{np.median(margins, axis=0).max():.3f}")
            judged = [sobol.INDICES.judge(found) for found in seeds]
            rates = [np.mean([SensitivityVerdict[kind] in v for v in judged]) for kind in VERDICTS]
            table.add_row(name, str(size), *map(" ".join, cells), *(f"{r:.3f}" for r in rates))
        for found in seeds:  # with all halves of the whole sample
            values = [found[f"{order}_by_samples"] for order in ORDERS[:2]]
            margins = [found[f"{order}_by_samples_interval"] for order in ORDERS[:2]]
            narrow = np.flatnonzero(np.max(margins, axis=(0, 2)) <= LIMIT)
            if narrow.size:
                at = narrow[0]
                errors = np.array(values)[:, at] - [exact[order] for order in ORDERS[:2]]
                held.append(abs(errors) <= np.array(margins)[:, at] + 1e-9)
                stops.append(SIZES[-1] >> (len(values[0]) - 1 - at))
        covered = f"{np.mean(held, axis=0).min():.2f}" if held else ""
        stopped.add_row(name, str(len(held)), covered, f"{np.median(stops or [0]):.0f}")
    Console(width=160).print(table, stopped)


if __name__ == "__main__":
    main()
