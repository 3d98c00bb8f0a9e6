"""An elastic beam under a slowly growing load: F L^3/(48 EI), and what shear adds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from impactlab.model.discretisation import Discretisation
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, curve
from impactlab.verification.slow_load import slow_impact
from impactlab.verification.solutions import bending, quadrature, shear

TITLE = "Static deflection"
SOURCE = "Closed forms of beam bending, with the integration rule's own stiffness"
_RULES = (("lobatto", 9), ("lobatto", 2), ("layers", 5))
_DURATION = 1.2


def check() -> Finding:
    """Deflection and curvature at mid-span against the load, over 1.2 s: 130 periods.

    And of a stubby Timoshenko beam over 0.1 s: 160 of its periods.
    """
    found = [_compare(rule, points) for rule, points in _RULES]
    comparisons = [entry for entries, _ in found for entry in entries]
    return Finding([*comparisons, *_sheared()], [found[0][1]])


def stiffness_ratio(rule: str, points: int) -> float:
    """The rule's second moment of area over the exact one: sum(w xi^2)/(2/3)."""
    positions, weights = quadrature.rule(rule, points)
    return float(1.5 * np.sum(weights * positions**2))


def _compare(rule: str, points: int) -> tuple[list[Comparison], Panel]:
    beam = paper_impact().beam
    impact = slow_impact(beam, mass=8e4, velocity=0.02, softness=50e-3)
    grid = Discretisation(nodes=101, points=points, rule=rule)
    run = simulate(impact, grid, duration=_DURATION)
    force = run["contact_force"].values / stiffness_ratio(rule, points)
    deflection = force * bending.static_deflection(beam, 1.0)
    curvature = -force * beam.span / (4.0 * beam.bending_stiffness)
    where = f"the paper's beam, {points} points ({rule})"
    ours = run["midspan_deflection"].values
    time = run["time"].values
    comparisons = [
        curve("deflection at mid-span", where, "m", ours, deflection, 1e-3),
        curve(
            "curvature at mid-span",
            where,
            "m-1",
            run["midspan_curvature"].values,
            curvature,
            1e-3,
        ),
    ]
    panel = Panel(
        where,
        ("time", "s"),
        ("deflection at mid-span", "m"),
        [Curve("solver", time, ours), Curve("F L³/(48 EI)", time, deflection, independent=True)],
    )
    return comparisons, panel


def _sheared() -> list[Comparison]:
    """A fourth of the paper's span, where shear adds 6.3 % to the deflection."""
    paper = paper_impact().beam
    beam = replace(paper, span=0.25 * paper.span)
    impact = slow_impact(beam, mass=8e4, velocity=0.24, softness=50e-3)
    grid = Discretisation(nodes=101, points=3)
    run = simulate(replace(impact, beam_model="timoshenko"), grid, duration=0.1)
    force = run["contact_force"].values
    w, expected = run["midspan_deflection"].values, force * shear.static_deflection(beam, 1.0)
    curvature = -force * beam.span / (4.0 * beam.bending_stiffness)
    kappa, where = run["midspan_curvature"].values, "a stubby Timoshenko beam, 3 points (lobatto)"
    return [
        curve("deflection at mid-span", where, "m", w, expected, 1e-3),
        curve("curvature at mid-span", where, "m-1", kappa, curvature, 1e-3),
    ]
