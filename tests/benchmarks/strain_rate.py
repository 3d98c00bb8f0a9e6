"""The effect of the strain rate on the corrected beam model, beside 3-D finite elements.

python tests/benchmarks/strain_rate.py

Writes docs/agreement_rates.csv: the change by each law of the strain rate, in % of the answer
without, on the paper's beam and sphere over the first contact. With and without are solved on the
same mesh, so that its error cancels; the waviness of the force remains, one percent on these
meshes (agreement.py). The 3-D runs, half an hour on a core, are kept in results/strain_rate; a
second call only solves the beams.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pandas as pd

import impactlab as il
from impactlab.fem3d.solver import solve

ROOT = Path(__file__).parents[2]
TABLE = ROOT / "docs" / "agreement_rates.csv"
CASES = {0.99: (0.5e-3, 0.35e-3), 5.0: (1e-3, 0.3e-3)}
"""Velocities (m/s) with element sizes (m) and durations (s)."""
STATIC = "static"
LAWS: dict[str, dict[str, float]] = {
    STATIC: {},
    "D = 40.4/s, q = 5": {"rate_coefficient": 40.4},
    "D = 3200/s, q = 5": {"rate_coefficient": 3200.0},
    "D = 6844/s, q = 3.91": {"rate_coefficient": 6844.0, "rate_exponent": 3.91},
    "C = 0.014": {"rate_sensitivity": 0.014},
    "C = 0.022": {"rate_sensitivity": 0.022},
}
"""Cowper and Symonds' and Johnson and Cook's constants, the reference rate 1/s."""
RESPONSES = (
    "peak_force",
    "contact_duration",
    "impulse",
    "maximum_indentation",
    "permanent_indentation",
)
SOLID, BEAM = "3-D", "corrected beam"


def struck(velocity: float, law: str) -> il.Impact:
    """Return the corrected impact with this law of the strain rate; velocity in m/s."""
    impact = il.corrected_impact(velocity)
    material = replace(impact.beam.material, **LAWS[law])
    return replace(impact, beam=replace(impact.beam, material=material))


def solid(velocity: float, law: str) -> dict[str, float]:
    """Return the responses of a 3-D run, which is read if it was solved before."""
    size, duration = CASES[velocity]
    name = f"{velocity:g}_{1e3 * size:g}_{law}.json".replace("/", " per ")
    path = ROOT / "results" / "strain_rate" / name
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        run = solve(struck(velocity, law), element_size=size, duration=duration)
        path.write_text(json.dumps({name: float(run[name]) for name in RESPONSES}))
        print(path.name, flush=True)
    return dict(json.loads(path.read_text()))


def beam(velocity: float, law: str) -> dict[str, float]:
    """Return the responses of the corrected beam model."""
    grid = il.Discretisation(nodes=201)
    run = il.simulate(struck(velocity, law), grid, duration=0.6e-3, samples=2)
    return {name: float(run[name]) for name in RESPONSES}


def changes(model: str, velocity: float, law: str) -> dict[str, float]:
    """Return what the law changes, in % of the answer without."""
    answers = {SOLID: solid, BEAM: beam}[model]
    rated, static = answers(velocity, law), answers(velocity, STATIC)
    return {name: 100.0 * (rated[name] / static[name] - 1.0) for name in RESPONSES}


def main() -> None:
    """Solve and tabulate."""
    rows = [
        {"velocity": velocity, "law": law, "model": model} | changes(model, velocity, law)
        for velocity in CASES
        for law in LAWS
        if law != STATIC
        for model in (SOLID, BEAM)
    ]
    table = pd.DataFrame(rows).round(2)
    table.to_csv(TABLE, index=False)
    print(table.to_string(index=False))


if __name__ == "__main__":
    main()
