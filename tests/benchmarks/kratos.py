"""The solid model beside Kratos Multiphysics on one mesh: a table, and docs/kratos.png.

    python tests/benchmarks/kratos.py

Needs the extra `kratos`; about 5 minutes of one core. What is solved is kept in results/kratos.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

import impactlab as il
from impactlab.figures import style
from impactlab.reference import kratos, solid

ROOT = Path(__file__).parents[2]
OURS = "impactlab"
PENALTIES = {"Kratos, 1e6 N/mm³": 1e15, "Kratos, 1e7 N/mm³": 1e16}
"""Runs of Kratos by their label; N/m3."""
LINES: dict[str, tuple[str, float, str]] = {
    "peak_force": ("peak contact force", 1e-3, "kN"),
    "time_of_peak_force": ("time of the peak", 1e6, "µs"),
    "contact_duration": ("contact duration", 1e6, "µs"),
    "deflection_at_peak": ("mid-span deflection at 120 µs", 1e6, "µm"),
    "deflection_at_end": ("mid-span deflection at 280 µs", 1e6, "µm"),
    "maximum_indentation": ("largest indentation", 1e6, "µm"),
    "permanent_indentation": ("permanent indentation", 1e6, "µm"),
    "peak_plastic_strain": ("largest PEEQ", 1e2, "%"),
    "plastic_zone_length": ("length of the plastic zone", 1e3, "mm"),
    "cpu_seconds": ("processor time", 1.0, "s"),
}
"""What is compared: words, factor from SI, unit."""
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
    mesh = solid.quarter_mesh(impact, element_size=size, coarsest=coarsest, ratio=ratio)
    folder = ROOT / "results" / "kratos" / f"{1e3 * size:g}_{1e3 * coarsest:g}_mm_{ratio:g}"
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements")
    runs = {OURS: kept(folder / "impactlab.nc", lambda: ours(mesh, impact))}
    for label, penalty in PENALTIES.items():
        path = folder / f"kratos_{penalty:g}.nc"
        runs[label] = kept(path, lambda penalty=penalty: theirs(mesh, impact, penalty))
    print(table(runs))
    drawn(runs).savefig(given.figure)


def kept(path: Path, solve: Callable[[], xr.Dataset]) -> xr.Dataset:
    """What was solved before, else what `solve` gives."""
    if not path.exists():
        solve().to_netcdf(path)
    return xr.load_dataset(path)


def ours(mesh: solid.Mesh, impact: il.Impact) -> xr.Dataset:
    """The solid model, compiled before its processor time is taken."""
    solid.solve_on(mesh, impact, duration=1e-6)
    start = time.process_time()
    run = solid.solve_on(mesh, impact, duration=1.02 * DURATION)
    return run.assign(cpu_seconds=time.process_time() - start)


def theirs(mesh: solid.Mesh, impact: il.Impact, penalty: float) -> xr.Dataset:
    return kratos.solve_on(mesh, impact, duration=DURATION, penalty=penalty, progress=told)


def told(now: float, share: float) -> None:
    print(f"{1e6 * now:.0f} µs ({share:.0%})", flush=True)


def table(runs: dict[str, xr.Dataset]) -> str:
    """The comparison in Markdown: Kratos' answers, and how far they are from ours."""
    lines = ["| | " + " | ".join(runs) + " |", "|---" * (len(runs) + 1) + "|"]
    for name, (words, factor, unit) in LINES.items():
        values = [factor * value_of(name, run) for run in runs.values()]
        others = [f"{value:.4g} ({100 * (value / values[0] - 1):+.1f} %)" for value in values[1:]]
        lines.append(f"| {words}, {unit} | {values[0]:.4g} | {' | '.join(others)} |")
    return "\n".join(lines)


def value_of(name: str, run: xr.Dataset) -> float:
    at = {"deflection_at_peak": 1.2e-4, "deflection_at_end": DURATION}
    if name in at:
        return float(run["midspan_deflection"].interp(time=at[name], method="linear"))
    return float(run[name])


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
