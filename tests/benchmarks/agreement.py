"""Beam models beside 3-D finite elements, each correction alone and all together.

python tests/benchmarks/agreement.py [ELEMENTS_PER_RADIUS ...]

Writes docs/agreement.csv, docs/agreement_laws.csv (every law on the corrected beam),
docs/agreement_later.csv (the contacts after the first) and docs/agreement.png. The 3-D runs, half
an hour on two cores, are kept in results/agreement: a second call only solves the beams. The
paper's beam and sphere over a range of velocities, and two beams and a sphere on whose answers no
correction was tuned; C of solver/contact/prestress.py is from the ratio of 3-D runs of the 40 mm
beam with and without a stress put into it beforehand. A run ends after its first contact, but for
those on the contacts after it.

While the metal flows, the force of one mesh waves about its mean: the contact grows by a ring of
elements at a time. Hence several meshes, whose rings fall between each other's: the reference is
the mean of their force histories, and its uncertainty half the range of their answers.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
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
from impactlab.solver.contact import LAWS

ROOT = Path(__file__).parents[2]
ELASTIC = 20e9
"""Yield stress of a beam that does not yield (Pa)."""
PAPER = {0.5: 0.32, 0.99: 0.28, 2.0: 0.25, 5.0: 0.21, 10.0: 0.19, 15.0: 0.19}
BODIES = {
    "paper": (27.8e-3, 35e-3, 345e6, PAPER),
    "H 40 mm, R 20 mm": (40e-3, 20e-3, 345e6, {0.99: 0.17, 5.0: 0.14}),
    "H 15 mm, R 20 mm": (15e-3, 20e-3, 345e6, {0.99: 0.17, 5.0: 0.14}),
    "paper, elastic": (27.8e-3, 35e-3, ELASTIC, {0.5: 0.33, 0.99: 0.29, 5.0: 0.22}),
}
"""Depth of the beam, radius of the sphere (m), yield stress of the beam (Pa; the sphere's is as
high at least); velocities (m/s) with durations (ms)."""
TIMOSHENKO = {"beam_model": "timoshenko"}
STRIP = TIMOSHENKO | {
    "contact_compliance": "strip",
    "contact": "finite_element",
    "load": "contact_patch",
}
CORRECTED = TIMOSHENKO | {"contact_compliance": "beam"}
MODELS = {
    "the paper's model": {},
    "Timoshenko beam": TIMOSHENKO,
    "compliance": CORRECTED,
    "contact law": {"contact": "finite_element"},
    "contact patch": {"load": "contact_patch"},
    "Timoshenko, law": TIMOSHENKO | {"contact": "finite_element"},
    "Timoshenko, law, stress": TIMOSHENKO
    | {"contact": "finite_element", "contact_prestress": "bending"},
    "Timoshenko, law, compliance": CORRECTED | {"contact": "finite_element"},
    "all but strip and stress": CORRECTED | {"contact": "finite_element", "load": "contact_patch"},
    "all but stress": STRIP,
    "all": STRIP | {"contact_prestress": "bending"},
}
MESHES, FINE = (5.0, 5.25, 5.5, 5.75), (11.0, 11.5, 12.0)
"""Elements over the radius of the contact; fine from 5 m/s on where metal yields: it flows farthest
there, and the runs are the shortest."""
LATER = dict.fromkeys((5.0, 10.0, 20.0), (6.0, 7.0))
"""Velocities (m/s) and meshes of the runs with several contacts, on the paper's beam."""
LATER_DURATION = 3e-3
UNCERTAINTY = "3-D, half the range of the meshes"
SHOWN = ("the paper's model", "Timoshenko, law", "all but stress", "all")
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
    for bodies, (depth, radius, stress, durations) in BODIES.items():
        for velocity, duration in durations.items():
            impact = il.paper_impact(velocity)
            steel = replace(impact.beam.material, yield_stress=stress)
            beam = replace(impact.beam, depth=depth, material=steel)
            hard = replace(impact.sphere.material, yield_stress=max(2550e6, stress))
            sphere = replace(impact.sphere, radius=radius, material=hard)
            yield bodies, velocity, 1e-3 * duration, replace(impact, beam=beam, sphere=sphere)


def mean_solid(
    impact: il.Impact, duration: float, meshes: Sequence[float], case: str = ""
) -> tuple[xr.Dataset, dict[str, float]]:
    """Return the mean of the 3-D runs on all meshes, and half the range of each response in %."""
    runs = [solid(impact, duration, elements, case) for elements in meshes]
    times = runs[0].time.values
    histories = np.array([np.interp(times, run.time, run.contact_force) for run in runs])
    mean = runs[0].assign(contact_force=("time", histories.mean(axis=0)))
    spread = {}
    for name in filter(mean.__contains__, RESPONSES):
        answers = np.array([float(run[name]) for run in runs])
        mean[name] = mean.contact_force.max() if name == "peak_force" else answers.mean()
        if name != "permanent_indentation" or impact.beam.material.yield_stress < ELASTIC:
            spread[name] = 50.0 * np.ptp(answers) / float(mean[name])
    expected = np.linalg.norm(mean.contact_force)
    apart = [np.linalg.norm(force - mean.contact_force) / expected for force in histories]
    spread["force_history"] = 100.0 * float(max(apart))
    return mean, spread


def solid(impact: il.Impact, duration: float, elements: float, case: str = "") -> xr.Dataset:
    """Solve an impact with 3-D finite elements, or read it if it was solved before.

    case: name of a case that differs by more than velocity, depth, radius and yield stress.
    """
    size = contact_radius(impact) / elements
    depth, radius = 1e3 * impact.beam.depth, 1e3 * impact.sphere.radius
    stress = 1e-6 * impact.beam.material.yield_stress
    name = f"{depth:g}_{radius:g}_{stress:g}_{impact.velocity:g}_{1e3 * duration:g}_{elements:g}.nc"
    if case:
        name = f"{case}, {elements:g}.nc"
    path = ROOT / "results" / "agreement" / name
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        run = solve(impact, element_size=size, duration=duration, threads=2)
        histories = "contact_force", "midspan_deflection"
        kept = [name for name in (*RESPONSES, *histories) if name in run]
        run[kept].drop_attrs(deep=False).to_netcdf(path)
        print(path.name, f"{1e3 * size:.3f} mm", flush=True)
    return xr.load_dataset(path)


def differences(impact: il.Impact, witness: xr.Dataset) -> dict[str, float]:
    """Return each response's difference from the 3-D run, in % of it."""
    times = witness.time.values
    run = il.simulate(impact, il.Discretisation(nodes=201), duration=times[-1], samples=2001)
    force = np.interp(times, run.time, run.contact_force)
    expected = witness.contact_force.values
    apart = {name: float(run[name] / witness[name]) - 1.0 for name in RESPONSES if name in witness}
    if float(run.permanent_indentation) == 0.0:  # what 3-D leaves is a wave, not a dent
        apart["permanent_indentation"] = np.nan
    apart["force_history"] = np.linalg.norm(force - expected) / np.linalg.norm(expected)
    return {name: 100.0 * apart[name] for name in RESPONSES}


def later() -> pd.DataFrame:
    """Return differences of the whole impulse and of the deflection from 3-D, in % of it."""
    rows = []
    for velocity, meshes in LATER.items():
        impact = il.paper_impact(velocity)
        runs = {f"3-D, {size:g}": solid(impact, LATER_DURATION, size) for size in meshes}
        for model in ("the paper's model", "all but strip and stress", "all"):
            ours = replace(impact, **MODELS[model])
            grid = il.Discretisation(nodes=201)
            runs[model] = il.simulate(ours, grid, duration=LATER_DURATION, samples=3001)
        table = pd.DataFrame({name: _whole(run) for name, run in runs.items()}).T
        mean = table.iloc[: len(meshes)].mean()
        apart = 100.0 * (table / mean - 1.0)
        rows.append(apart.rename_axis("model").reset_index().assign(velocity=velocity))
    return pd.concat(rows)


def _whole(run: xr.Dataset) -> dict[str, float]:
    """Return impulse (N s) and largest and last deflection (m) of a run, whatever it ends in."""
    w = run.midspan_deflection.values
    impulse = float(np.trapezoid(run.contact_force, run.time))
    return {"impulse": impulse, "largest deflection": w.max(), "deflection at 3 ms": w[-1]}


@style.paper
def drawn(table: pd.DataFrame) -> Figure:
    """Draw a panel per response: difference against velocity."""
    figure, axes = style.panels(len(RESPONSES), columns=3, height=50, sharex=True)
    for ax, (response, title) in zip(axes, RESPONSES.items(), strict=True):
        limit = 5.0 if response == "force_history" else 2.0
        ax.axhspan(-limit if response != "force_history" else 0.0, limit, color="0.9", lw=0)
        for model, colour, line in zip(SHOWN, style.COLOURS, style.LINES, strict=False):
            rows = table[(table.model == model) & (table.bodies == "paper")]
            ax.plot(rows.velocity, rows[response], color=colour, ls=line, label=model)
            for bodies, marker in zip(list(BODIES)[1:3], "sv", strict=True):
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


def main(meshes: Sequence[float]) -> None:
    """Solve, tabulate and draw."""
    rows, by_law = [], []
    for bodies, velocity, duration, impact in impacts():
        fine = velocity >= 5.0 and impact.beam.material.yield_stress < ELASTIC
        witness, spread = mean_solid(impact, duration, meshes or (FINE if fine else MESHES))
        rows.append({"bodies": bodies, "velocity": velocity, "model": UNCERTAINTY} | spread)
        for model, options in MODELS.items():
            errors = differences(replace(impact, **options), witness)
            rows.append({"bodies": bodies, "velocity": velocity, "model": model} | errors)
        for law in LAWS if impact.beam.material.yield_stress < ELASTIC else ():
            errors = differences(replace(impact, **CORRECTED | {"contact": law}), witness)
            by_law.append({"law": law} | errors)
    table = pd.DataFrame(rows)
    table.round(2).to_csv(ROOT / "docs" / "agreement.csv", index=False)
    largest = pd.DataFrame(by_law).set_index("law").abs().groupby("law", sort=False).max()
    largest.round(2).to_csv(ROOT / "docs" / "agreement_laws.csv")
    later().round(1).to_csv(ROOT / "docs" / "agreement_later.csv", index=False)
    drawn(table).savefig(ROOT / "docs" / "agreement.png", dpi=200)
    print(table.round(1).to_string(index=False))


if __name__ == "__main__":
    main([float(elements) for elements in sys.argv[1:]])
