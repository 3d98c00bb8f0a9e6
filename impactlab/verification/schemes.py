"""The two time schemes against the modal series and a fine run, and the stability of random cases.

Both discretise space in the same way, so their errors are of similar size: the time error of the
semi-implicit scheme must stay below the space error of the nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate, simulate_many
from impactlab.solver import RULES, SCHEMES
from impactlab.verification import modal_series
from impactlab.verification.cases import discretised
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    responses,
    rms_error,
    worst,
)
from impactlab.verification.solutions.contact_laws import LAWS
from impactlab.verification.solutions.modal import solve

ELASTIC_NODES = (201, 601)
YIELDING_NODES, FINE = 601, 1601
VELOCITIES = (15.0, 20.0)
DURATION = 1.5e-3
"""Duration of the yielding cases in s, past the last of the sub-impacts."""
TOLERANCES = {
    "peak_force": 3e-4,
    "permanent_indentation": 3e-4,
    "contact_duration": 1e-3,
    "total_contact_time": 3e-3,
    "impulse": 1e-3,
    "plastic_dissipation": 5e-3,
    "remote_plastic_strain": 2e-2,
    "plastic_zone_length": 1e-2,
}
"""A few times leapfrog's error at 601 nodes against the fine run, where some errors pass through
zero. The peak plastic strain is left out, because it need not converge."""

NODES = (51, 101, 201, 401, 601, 801)
"""Numbers of nodes in the figures."""
_NAMES = {scheme: scheme.replace("_", "-") for scheme in SCHEMES}


@check(
    "Schemes in time",
    "the elastic beam's modal series; leapfrog with 1601 nodes; conservation of energy",
)
def schemes() -> Finding:
    """Compare both schemes at fixed nodes, the energy of random cases, and errors by cost."""
    return Finding([*_elastic(), *_yielding(), _stable()], [_elastic_panel(), _yielding_panel()])


def _run(
    impact: Impact, scheme: str, nodes: int, duration: float, points: int = 9, samples: int = 401
) -> xr.Dataset:
    grid = Discretisation(nodes=nodes, points=points, scheme=scheme)
    return simulate(impact, grid, duration=duration, samples=samples)


def _elastic() -> list[Comparison]:
    """Compare the histories of each beam at its second velocity; keep the worst beam."""
    table = []
    for beam, case in modal_series.BERNOULLI_CASES.items():
        impact = replace(case.impact, velocity=case.velocities[1])
        series = solve(impact, case.duration)
        found: list[Comparison] = []
        for scheme in SCHEMES:
            where = f"{_NAMES[scheme]}: {beam}, {impact.velocity:g} m/s"
            for nodes in ELASTIC_NODES:
                run = _run(impact, scheme, nodes, case.duration, points=3)
                found += modal_series.histories(where, run, series)
        table.append(found)
    return list(map(worst, zip(*table, strict=True)))


def _yielding() -> list[Comparison]:
    """Compare the responses of the paper's perfectly plastic beam."""
    found: list[Comparison] = []
    for velocity in VELOCITIES:
        fine = _run(paper_impact(velocity), "leapfrog", FINE, DURATION, samples=2)
        for scheme in SCHEMES:
            where = f"{_NAMES[scheme]}: {velocity:g} m/s, {YIELDING_NODES} nodes"
            run = _run(paper_impact(velocity), scheme, YIELDING_NODES, DURATION, samples=2)
            for name, tolerance in TOLERANCES.items():
                found += responses(run, where, {name: fine[name].item()}, tolerance)
    return found


def drawn(number: int, seed: int) -> dict[str, Any]:
    """Draw the parameters of random cases, one array each: rules, laws, sizes and hardening."""
    random = np.random.default_rng(seed)
    hardening = np.array([0.0, 2e9, 20e9])
    return {
        "velocity": np.exp(random.uniform(np.log(0.5), np.log(60.0), number)),
        "contact": random.choice(list(LAWS), number),
        "sphere_radius": random.uniform(0.01, 0.05, number),
        "beam_span": random.uniform(0.3, 1.0, number),
        "beam_width": random.uniform(0.02, 0.1, number),
        "beam_depth": random.uniform(0.01, 0.05, number),
        "beam_yield_stress": random.uniform(150e6, 600e6, number),
        "beam_isotropic_hardening_modulus": random.choice(hardening, number),
        "beam_kinematic_hardening_modulus": random.choice(hardening, number),
        "nodes": 2 * random.integers(25, 301, number) + 1,
        "points": random.integers(2, 22, number),
        "rule": random.choice(RULES, number),
        "courant": random.uniform(0.3, 1.0, number),
    }


def _stable() -> Comparison:
    """Compare the worst energy balance of the semi-implicit scheme; a diverged run has none."""
    grid = Discretisation(scheme="semi_implicit")
    runs = simulate_many(paper_impact(), grid, duration=4e-3, varied=drawn(48, seed=1))
    found = []
    for _, run in runs.groupby("run", squeeze=False):
        where = (
            f"semi-implicit: {run.velocity.item():.3g} m/s, {run.contact.item()}, "
            f"{run.nodes.item()} nodes, {run.points.item()} points, {run.rule.item()}"
        )
        found.append(absolute("energy error", where, "1", run.energy_error.item(), 0.0, 1e-2))
    return worst(found)


def _elastic_panel() -> Panel:
    case = modal_series.BERNOULLI_CASES["the paper's beam"]
    series = solve(case.impact, case.duration)

    def errors(run: xr.Dataset) -> dict[str, float]:
        return {
            f"history of {modal_series.HISTORIES[name][0]}": modal_series.error(name, series, run)
            for name in ("contact_force", "midspan_curvature")
        }

    return _panel("elastic, 0.99 m/s", case.impact, case.duration, errors)


def _yielding_panel() -> Panel:
    impact = paper_impact(VELOCITIES[0])
    fine = _run(impact, "leapfrog", FINE, DURATION)

    def errors(run: xr.Dataset) -> dict[str, float]:
        apart = rms_error(run.contact_force.values, fine.contact_force.values)
        peak = abs(float(run.peak_force / fine.peak_force) - 1.0)
        return {"history of contact force": apart, "peak force": peak}

    return _panel(f"yielding, {VELOCITIES[0]:g} m/s", impact, DURATION, errors)


def _panel(
    title: str, impact: Impact, duration: float, errors: Callable[[xr.Dataset], dict[str, float]]
) -> Panel:
    """Draw the errors of both schemes against their cost, from 51 to 801 nodes."""
    curves = []
    for scheme in SCHEMES:
        grids = [Discretisation(nodes=nodes, scheme=scheme) for nodes in NODES]
        steps = [discretised(impact, grid, duration)[1] for grid in grids]
        cost = np.array(NODES) // 2 * np.array(steps, dtype=np.float64)
        found = [errors(_run(impact, scheme, nodes, duration)) for nodes in NODES]
        for name in found[0]:
            label = f"{_NAMES[scheme]}: {name}"
            curves.append(Curve(label, cost, np.array([entry[name] for entry in found])))
    axes = ("nodes of the half beam × time steps", "1"), ("error", "1")
    return Panel(title, *axes, curves, log=True)
