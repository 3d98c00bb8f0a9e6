"""The solid model beside Kratos Multiphysics on one mesh: a table, and docs/kratos.png.

    python tests/benchmarks/kratos.py

Needs the extra `kratos`; about 5 minutes of one core. What is solved is kept in results/kratos.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import impactlab as il
from impactlab.fem3d import kratos
from impactlab.fem3d import solver as solid
from impactlab.fem3d.solver import system
from impactlab.figures import style

ROOT = Path(__file__).parents[2]
OURS, SMALL = "impactlab", "impactlab, small strains"
PENALTIES = {"Kratos, 1e6 N/mm³": 1e15, "Kratos, 1e7 N/mm³": 1e16}
"""Runs of Kratos by their label; N/m3."""
LINES: dict[str, tuple[str, float | None, float]] = {
    "contact force at 80 µs, kN": ("contact_force", 80e-6, 1e-3),
    "indentation at 80 µs, µm": ("indentation", 80e-6, 1e6),
    "mid-span deflection at 80 µs, µm": ("midspan_deflection", 80e-6, 1e6),
    "mid-span deflection at 120 µs, µm": ("midspan_deflection", 120e-6, 1e6),
    "mid-span deflection at 270 µs, µm": ("midspan_deflection", 270e-6, 1e6),
    "peak contact force, kN": ("peak_force", None, 1e-3),
    "time of the peak, µs": ("time_of_peak_force", None, 1e6),
    "contact duration, µs": ("contact_duration", None, 1e6),
    "largest indentation, µm": ("maximum_indentation", None, 1e6),
    "permanent indentation, µm": ("permanent_indentation", None, 1e6),
    "largest PEEQ, %": ("peak_plastic_strain", None, 1e2),
    "length of the plastic zone, mm": ("plastic_zone_length", None, 1e3),
}
"""What is compared: variable, time in s of a history, factor from SI."""
DURATION = 2.8e-4


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--element-size", type=float, default=1e-3, help="about the contact, m")
    parser.add_argument("--coarsest", type=float, default=20e-3, help="far from it, m")
    parser.add_argument("--ratio", type=float, default=2.0, help="of neighbours in between")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "kratos.png")
    given = parser.parse_args()
    impact = il.paper_impact(velocity=0.99)
    size, coarsest, ratio = given.element_size, given.coarsest, given.ratio
    mesh = solid.impact_mesh(impact, element_size=size, coarsest=coarsest, ratio=ratio)
    # Where nodes match, Kratos' dual multipliers act on pairs of nodes: so does our contact here.
    mesh = replace(mesh, bulge=np.zeros_like(mesh.bulge))
    system.RULE = np.eye(4), np.eye(4)
    folder = ROOT / "results" / "kratos" / f"{1e3 * size:g}_{1e3 * coarsest:g}_mm_{ratio:g}"
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements")
    runs = {OURS: kept(folder / "impactlab.nc", lambda: ours(mesh, impact))}
    with shape_kept():
        runs[SMALL] = kept(folder / "small_strains.nc", lambda: ours(mesh, impact))
    for label, penalty in PENALTIES.items():
        path = folder / f"kratos_{penalty:g}.nc"
        runs[label] = kept(path, lambda penalty=penalty: theirs(mesh, impact, penalty))
    print(table(runs))
    drawn({label: run for label, run in runs.items() if label != SMALL}).savefig(given.figure)


def kept(path: Path, solve: Callable[[], xr.Dataset]) -> xr.Dataset:
    """Return the stored answer, or that of `solve`."""
    if not path.exists():
        solve().to_netcdf(path)
    return xr.load_dataset(path)


def ours(mesh: solid.Mesh, impact: il.Impact) -> xr.Dataset:
    """The solid model, compiled before its processor time is taken."""
    solid.solve_on(mesh, impact, duration=1e-6)
    start = time.process_time()
    run = solid.solve_on(mesh, impact, duration=1.02 * DURATION)
    return run.assign(cpu_seconds=time.process_time() - start)


@contextmanager
def shape_kept() -> Iterator[None]:
    """Within, the solid model's strains are of the first shape, as those of Kratos' elements."""
    strain = system.System.strain

    def from_the_first(own: system.System, dt: float) -> None:
        x, own.x = own.x, own.mesh.nodes
        try:
            strain(own, dt)
        finally:
            own.x = x

    system.System.strain = from_the_first
    try:
        yield
    finally:
        system.System.strain = strain


def theirs(mesh: solid.Mesh, impact: il.Impact, penalty: float) -> xr.Dataset:
    return kratos.solve_on(mesh, impact, duration=DURATION, penalty=penalty, progress=told)


def told(share: float) -> None:
    print(f"{1e6 * share * DURATION:.0f} µs ({share:.0%})", flush=True)


def table(runs: dict[str, xr.Dataset]) -> str:
    """The comparison in Markdown: Kratos' answers, and how far they are from ours."""
    lines = ["| | " + " | ".join(runs) + " |", "|---" * (len(runs) + 1) + "|"]
    for words, line in LINES.items():
        values = [value_of(run, *line) for run in runs.values()]
        others = [compared(value, values[0]) for value in values[1:]]
        lines.append(f"| {words} | {values[0]:.4g} | {' | '.join(others)} |")
    seconds = [f"{run.cpu_seconds.item():.2g} s" for run in runs.values()]
    return "\n".join([*lines, f"| processor time | {' | '.join(seconds)} |"])


def compared(value: float, reference: float) -> str:
    change = 100.0 * (value / reference - 1.0)
    return "not reached" if math.isnan(value) else f"{value:.4g} ({change:+.1f} %)"


def value_of(run: xr.Dataset, name: str, at: float | None, factor: float) -> float:
    """NaN where a run ends before."""
    values = run[name]
    return factor * float(values if at is None else values.interp(time=at))


@style.paper
def drawn(runs: dict[str, xr.Dataset]) -> Figure:
    """Force, deflection and indentation against time."""
    figure, axes = style.panels(3, columns=3, height=55)
    shown = {
        "contact_force": ("contact force, kN", 1e-3),
        "midspan_deflection": ("mid-span deflection, µm", 1e6),
        "indentation": ("indentation, µm", 1e6),
    }
    for ax, (name, (label, factor)) in zip(axes, shown.items(), strict=True):
        for at, (words, run) in enumerate(runs.items()):
            look = {"linestyle": "", "marker": style.MARKERS[at], "fillstyle": "none"} if at else {}
            ax.plot(
                1e6 * run["time"], factor * run[name], color=style.COLOURS[at], label=words, **look
            )
        ax.set_xlabel("time since first touch, µs")
        ax.set_ylabel(label)
        ax.set_xlim(0.0, 1e6 * DURATION)
        ax.set_ylim(0.0, None)
    style.legend(figure)
    return figure


if __name__ == "__main__":
    main()
