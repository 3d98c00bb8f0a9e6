"""Beam models beside 3-D finite elements, each correction alone and all together.

python tests/benchmarks/agreement.py [ELEMENTS_PER_RADIUS]

Writes docs/agreement.csv and docs/agreement.png. The 3-D runs, a few minutes on two cores, are kept
in results/agreement: a second call only solves the beams. The paper's beam and sphere over a range
of velocities, and two beams and a sphere on which no correction was tuned. A run ends after its
first contact.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

import impactlab as il
from impactlab.fem3d.solver import solve
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.figures import style

ROOT = Path(__file__).parents[2]
BODIES = {
    "paper": (27.8e-3, 35e-3, {0.5: 0.32, 0.99: 0.28, 2.0: 0.25, 5.0: 0.21, 10.0: 0.19}),
    "H 40 mm, R 20 mm": (40e-3, 20e-3, {0.99: 0.17, 5.0: 0.14}),
    "H 15 mm, R 20 mm": (15e-3, 20e-3, {0.99: 0.17, 5.0: 0.14}),
}
"""Depth of the beam and radius of the sphere (m); velocities (m/s) with durations (ms)."""
TIMOSHENKO = {"beam_model": "timoshenko"}
MODELS = {
    "the paper's model": {},
    "Timoshenko beam": TIMOSHENKO,
    "compliance": TIMOSHENKO | {"contact_compliance": "beam"},
    "contact law": {"contact": "finite_element"},
    "contact patch": {"load": "contact_patch"},
    "Timoshenko, law": TIMOSHENKO | {"contact": "finite_element"},
    "Timoshenko, law, compliance": TIMOSHENKO
    | {"contact": "finite_element", "contact_compliance": "beam"},
    "all": TIMOSHENKO
    | {"contact": "finite_element", "contact_compliance": "beam", "load": "contact_patch"},
}
SHOWN = ("the paper's model", "contact law", "Timoshenko, law", "Timoshenko, law, compliance")
RESPONSES = {
    "peak_force": "peak force",
    "contact_duration": "contact duration",
    "impulse": "impulse",
    "maximum_indentation": "largest indentation",
    "permanent_indentation": "permanent indentation",
    "force_history": "force history (L2)",
}


def impacts() -> Iterator[tuple[str, float, float, il.Impact]]:
    """Yield name of the bodies, velocity (m/s), duration (s) and the paper's model of each case."""
    for bodies, (depth, radius, durations) in BODIES.items():
        for velocity, duration in durations.items():
            impact = il.paper_impact(velocity)
            beam = replace(impact.beam, depth=depth)
            sphere = replace(impact.sphere, radius=radius)
            yield bodies, velocity, 1e-3 * duration, replace(impact, beam=beam, sphere=sphere)


def solid(impact: il.Impact, duration: float, elements: float) -> xr.Dataset:
    """Solve an impact with 3-D finite elements, or read it if it was solved before."""
    size = contact_radius(impact) / elements
    depth, radius = 1e3 * impact.beam.depth, 1e3 * impact.sphere.radius
    name = f"{depth:g}_{radius:g}_{impact.velocity:g}_{1e3 * duration:g}_{elements:g}.nc"
    path = ROOT / "results" / "agreement" / name
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        run = solve(impact, element_size=size, duration=duration, threads=2)
        kept = [name for name in (*RESPONSES, "contact_force") if name in run]
        run[kept].drop_attrs(deep=False).to_netcdf(path)
        print(path.name, f"{1e3 * size:.3f} mm", flush=True)
    return xr.load_dataset(path)


def differences(impact: il.Impact, witness: xr.Dataset) -> dict[str, float]:
    """Return each response's difference from the 3-D run, in % of it."""
    times = witness.time.values
    run = il.simulate(impact, il.Discretisation(nodes=201), duration=times[-1], samples=2001)
    force = np.interp(times, run.time, run.contact_force)
    expected = witness.contact_force.values
    apart = {name: float(run[name] / witness[name]) - 1.0 for name in RESPONSES if name in run}
    apart["force_history"] = np.linalg.norm(force - expected) / np.linalg.norm(expected)
    return {name: 100.0 * apart[name] for name in RESPONSES}


@style.paper
def drawn(table: pd.DataFrame) -> Figure:
    """Draw a panel per response: difference against velocity."""
    figure, axes = style.panels(len(RESPONSES), columns=3, height=50, sharex=True)
    for ax, (response, title) in zip(axes, RESPONSES.items(), strict=True):
        limit = 5.0 if response == "force_history" else 2.0
        ax.axhspan(-limit if response != "force_history" else 0.0, limit, color="0.9", lw=0)
        for at, model in enumerate(SHOWN):
            rows = table[(table.model == model) & (table.bodies == "paper")]
            colour = style.COLOURS[at]
            ax.plot(rows.velocity, rows[response], color=colour, ls=style.LINES[at], label=model)
            for bodies, marker in zip(list(BODIES)[1:], "sv", strict=True):
                others = table[(table.model == model) & (table.bodies == bodies)]
                ax.plot(others.velocity, others[response], marker, ms=4, mfc="none", color=colour)
        ax.set_title(title, loc="left")
        ax.set_xscale("log")
        ax.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
        ax.minorticks_off()
    figure.supxlabel("impact velocity, m/s")
    figure.supylabel("difference from 3-D finite elements, %")
    style.legend(figure)
    return figure


def main(elements: float) -> None:
    """Solve, tabulate and draw."""
    rows = []
    for bodies, velocity, duration, impact in impacts():
        witness = solid(impact, duration, elements)
        for model, options in MODELS.items():
            found = differences(replace(impact, **options), witness)
            rows.append({"bodies": bodies, "velocity": velocity, "model": model} | found)
    table = pd.DataFrame(rows)
    table.round(2).to_csv(ROOT / "docs" / "agreement.csv", index=False)
    drawn(table).savefig(ROOT / "docs" / "agreement.png")
    print(table.round(1).to_string(index=False))


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 5.0)
