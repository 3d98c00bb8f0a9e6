"""The solid model beside Kratos Multiphysics on one mesh: a table, and docs/kratos.png.

    python tests/benchmarks/kratos.py

Needs the extra `kratos`; about 10 minutes of one core. What is solved is kept in results/kratos.
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
OURS, THEIRS = "impactlab", "Kratos"
LINES: dict[str, tuple[str, float, str]] = {
    "peak_force": ("peak contact force", 1e-3, "kN"),
    "time_of_peak_force": ("time of the peak", 1e6, "µs"),
    "contact_duration": ("contact duration", 1e6, "µs"),
    "deflection_at_peak": ("mid-span deflection at the peak", 1e6, "µm"),
    "deflection_at_end": ("mid-span deflection at the end", 1e6, "µm"),
    "maximum_indentation": ("largest indentation", 1e6, "µm"),
    "permanent_indentation": ("permanent indentation", 1e6, "µm"),
    "peak_plastic_strain": ("largest PEEQ", 1e2, "%"),
    "plastic_zone_length": ("length of the plastic zone", 1e3, "mm"),
    "cpu_seconds": ("processor time", 1.0, "s"),
}
"""What is compared: words, factor from SI, unit."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--element-size", type=float, default=1e-3, help="m")
    parser.add_argument("--duration", type=float, default=3.2e-4, help="s")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "kratos.png")
    given = parser.parse_args()
    impact = il.paper_impact(velocity=0.99)
    mesh = solid.quarter_mesh(impact, element_size=given.element_size)
    folder = ROOT / "results" / "kratos"
    folder.mkdir(parents=True, exist_ok=True)
    name = f"{1e3 * given.element_size:g}_mm.nc"
    theirs = kept(
        folder / f"kratos_{name}",
        lambda: kratos.solve_on(mesh, impact, duration=given.duration, progress=told),
    )
    ours = kept(
        folder / f"impactlab_{name}",
        lambda: timed(lambda: solid.solve_on(mesh, impact, duration=1.02 * given.duration)),
    )
    print(f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements, {theirs.attrs['model']}")
    print(table(at_common_times(ours, theirs), at_common_times(theirs, theirs)))
    drawn(ours, theirs).savefig(given.figure)


def kept(path: Path, solve: Callable[[], xr.Dataset]) -> xr.Dataset:
    """What was solved before, else what `solve` gives."""
    if not path.exists():
        solve().to_netcdf(path)
    return xr.load_dataset(path)


def timed(solve: Callable[[], xr.Dataset]) -> xr.Dataset:
    """With the processor time of the whole process."""
    start = time.process_time()
    return solve().assign(cpu_seconds=lambda _: time.process_time() - start)


def told(now: float, share: float) -> None:
    print(f"{1e6 * now:.0f} µs ({share:.0%})", flush=True)


def at_common_times(run: xr.Dataset, clock: xr.Dataset) -> xr.Dataset:
    """With deflections at the times of the clock's largest force and of its end."""
    deflection = run["midspan_deflection"]
    return run.assign(
        deflection_at_peak=deflection.interp(time=float(clock["time_of_peak_force"])),
        deflection_at_end=deflection.interp(time=float(clock["time"][-1])),
    )


def table(ours: xr.Dataset, theirs: xr.Dataset) -> str:
    """The comparison in Markdown."""
    lines = [f"| | {OURS} | {THEIRS} | {THEIRS} over {OURS} |", "|---|---|---|---|"]
    for name, (words, factor, unit) in LINES.items():
        one, other = factor * float(ours[name]), factor * float(theirs[name])
        lines.append(
            f"| {words} | {one:.4g} {unit} | {other:.4g} {unit} | {other / one - 1:+.1%} |"
        )
    return "\n".join(lines)


@style.paper
def drawn(ours: xr.Dataset, theirs: xr.Dataset) -> Figure:
    """Force and deflection against time."""
    figure, axes = style.panels(2, columns=2, height=60)
    shown = {"contact_force": ("contact force, kN", 1e-3)}
    shown["midspan_deflection"] = ("mid-span deflection at mid-depth, µm", 1e6)
    for ax, (name, (label, factor)) in zip(axes, shown.items(), strict=True):
        ax.plot(1e6 * ours["time"], factor * ours[name], color=style.COLOURS[0], label=OURS)
        look = {"color": style.COLOURS[1], "marker": "o", "linestyle": "", "label": THEIRS}
        ax.plot(1e6 * theirs["time"], factor * theirs[name], **look)
        ax.set_xlabel("time since first touch, µs")
        ax.set_ylabel(label)
        ax.set_xlim(0.0, 1e6 * float(theirs["time"][-1]))
        ax.set_ylim(0.0, None)
    style.legend(figure)
    return figure


if __name__ == "__main__":
    main()
