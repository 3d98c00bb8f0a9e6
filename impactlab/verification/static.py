"""A slowly growing load, by a heavy, slow striker: static deflection, and static collapse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Beam, paper_impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import slow_impact
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    curve,
    relative,
)
from impactlab.verification.solutions import bending, collapse, quadrature, shear

_RULES = (("lobatto", 9), ("lobatto", 2), ("layers", 5))
_DEFLECTION_DURATION = 1.2


def check_static_deflection() -> Finding:
    """Compare deflection and curvature at mid-span with the load, over 1.2 s: 130 periods.

    And of a stubby Timoshenko beam over 0.1 s: 160 of its periods.
    """
    found = [_compare(rule, points) for rule, points in _RULES]
    comparisons = [entry for entries, _ in found for entry in entries]
    return Finding([*comparisons, *_sheared()], [found[0][1]])


STATIC_DEFLECTION = Check(
    "static_deflection",
    "Static deflection",
    "Closed forms of beam bending, with the integration rule's own stiffness",
    check_static_deflection,
)


def stiffness_ratio(rule: str, points: int) -> float:
    """Return the rule's second moment of area over the exact one: sum(w xi^2)/(2/3)."""
    positions, weights = quadrature.rule(rule, points)
    return float(1.5 * np.sum(weights * positions**2))


def _compare(rule: str, points: int) -> tuple[list[Comparison], Panel]:
    beam = paper_impact().beam
    impact = slow_impact(beam, mass=8e4, velocity=0.02, softness=50e-3)
    grid = Discretisation(nodes=101, points=points, rule=rule)
    run = simulate(impact, grid, duration=_DEFLECTION_DURATION)
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
    """Compare a fourth of the paper's span, where shear adds 6.3 % to the deflection."""
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


_HINGE = 20e-3
"""Mid-span deflection in m above which the load is constant: 20/9 of 6.1 mm at first yield."""
_LARGEST = 30e-3
"""Deflection in m up to which curves are compared; every run exceeds it."""
_COLLAPSE_DURATION = 1.0
"""In s, 107 periods: the striker stops, and has left after 0.86 s."""


def check_static_collapse() -> Finding:
    """Compare load against deflection, plateau, permanent deflection; plateaus of coarse rules."""
    perfect = _beam(0.0)
    run = _run_collapse(perfect, "layers", 40)
    hardening = _beam(5e9)
    harder = _run_collapse(hardening, "layers", 40)
    limit = bending.collapse_load(perfect)
    comparisons = [
        _loading(run, perfect, "elastic-perfectly plastic, 40 layers", 8e-3),
        _loading(harder, hardening, "isotropic hardening 5 GPa, 40 layers", 4e-3),
        relative("collapse load", "40 layers; 4 M_p/L", "N", _plateau(run), limit, 5e-4),
        *(_coarse(perfect, points) for points in (3, 9)),
        _permanent(run, perfect),
    ]
    return Finding(comparisons, [_collapse_panel(run, harder, perfect, hardening)])


STATIC_COLLAPSE = Check(
    "static_collapse",
    "Static collapse",
    "Prager and Hodge 1951, chapter 2; impactlab.verification.solutions.collapse",
    check_static_collapse,
)


def _beam(isotropic: float) -> Beam:
    beam = paper_impact().beam
    return replace(beam, material=replace(beam.material, isotropic_hardening_modulus=isotropic))


def _run_collapse(beam: Beam, rule: str, points: int) -> xr.Dataset:
    impact = slow_impact(beam, mass=4e4, velocity=0.2, softness=20e-3)
    grid = Discretisation(nodes=101, points=points, rule=rule)
    return simulate(impact, grid, duration=_COLLAPSE_DURATION, samples=4001)


def _on_loading(run: xr.Dataset) -> tuple[Floats, Floats]:
    """Return (deflection, force) at mid-span until the deflection is largest."""
    deflection, force = run["midspan_deflection"].values, run["contact_force"].values
    until = int(np.argmax(deflection)) + 1
    return deflection[:until], force[:until]


def _static(beam: Beam, deflections: Floats) -> Floats:
    return np.array([collapse.load_at(beam, float(w)) for w in deflections])


def _loading(run: xr.Dataset, beam: Beam, where: str, tolerance: float) -> Comparison:
    deflection, force = _on_loading(run)
    points = np.linspace(0.5e-3, _LARGEST, 100)
    ours = np.interp(points, deflection, force)
    return curve("load by deflection", where, "N", ours, _static(beam, points), tolerance)


def _plateau(run: xr.Dataset) -> float:
    """Return the mean load in N once the hinge has formed, which averages out vibrations."""
    deflection, force = _on_loading(run)
    return float(force[deflection > _HINGE].mean())


def _coarse(beam: Beam, points: int) -> Comparison:
    """Compare the plateau with the plastic moment of the coarse rule, not of the section."""
    positions, weights = quadrature.rule("lobatto", points)
    far = 1e3 * bending.yield_curvature(beam)
    own = 4.0 / beam.span * float(bending.rule_moment(beam, far, positions, weights))
    ours = _plateau(_run_collapse(beam, "lobatto", points))
    where = f"{points} Lobatto points; 4/L times the rule's own plastic moment"
    return relative("collapse load", where, "N", ours, own, 5e-4)


def _permanent(run: xr.Dataset, beam: Beam) -> Comparison:
    """Compare the deflection left: the striker leaves slowly, the beam springs back elastically."""
    limit = bending.collapse_load(beam)
    left = float(run["midspan_deflection"].max()) - bending.static_deflection(beam, limit)
    ours = float(run["midspan_deflection"][-400:].mean())
    where = "40 layers; largest deflection less P_c L^3/(48 EI)"
    return relative("permanent deflection", where, "m", ours, left, 1e-3)


def _collapse_panel(run: xr.Dataset, harder: xr.Dataset, perfect: Beam, hardening: Beam) -> Panel:
    curves = []
    for label, dataset, beam in (
        ("perfectly plastic", run, perfect),
        ("hardening 5 GPa", harder, hardening),
    ):
        deflection, force = dataset["midspan_deflection"].values, dataset["contact_force"].values
        points = np.linspace(0.5e-3, _LARGEST, 60)
        curves.append(Curve(label, deflection, force))
        curves.append(Curve(f"{label}, static", points, _static(beam, points), independent=True))
    axes = ("deflection at mid-span", "m"), ("load at mid-span", "N")
    return Panel("Loading to collapse, and back", *axes, curves)
