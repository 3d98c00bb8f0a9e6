"""The plastic section bent to and fro, and one plastic hinge that takes all of the energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Beam, Impact, paper_impact
from impactlab.simulate import case_table, simulate
from impactlab.solver import RULES, section
from impactlab.types import Floats
from impactlab.verification.finding import Check, Comparison, Curve, Finding, Panel, curve, relative
from impactlab.verification.solutions import bending, collapse, quadrature

_HARDENING = {
    "perfectly plastic": {},
    "isotropic 10 GPa": {"isotropic_hardening_modulus": 10e9},
    "kinematic 10 GPa": {"kinematic_hardening_modulus": 10e9},
}
_POINTS = (2, 3, 4, 9, 21)
_FINE = ("legendre", 100)
_TURN = 6.0
"""Largest curvature over that at first yield."""


def check_moment_curvature() -> Finding:
    """Compare two loops of each hardening: rules with their fibres, a fine one with M."""
    path = _path()
    comparisons, curves = [], []
    for name, moduli in _HARDENING.items():
        beam = paper_impact().beam
        beam = replace(beam, material=replace(beam.material, **moduli))
        kappa = path * bending.yield_curvature(beam)
        ours = moments(beam, *_FINE, kappa)
        comparisons += [_rules(name, beam, kappa), _exact(name, beam, kappa, ours)]
        curves.append(Curve(name, kappa, ours))
        curves.append(Curve(f"{name}, exact", kappa, _exact_moments(beam, kappa), True))
    axes = ("curvature", "m-1"), ("bending moment", "N m")
    return Finding(comparisons, [Panel("Bent to and fro", *axes, curves)])


MOMENT_CURVATURE = Check(
    "moment_curvature",
    "Moment and curvature",
    "Masing 1926; stresses clipped fibre by fibre in impactlab.verification.solutions.bending",
    check_moment_curvature,
)


def moments(beam: Beam, rule: str, points: int, curvatures: Floats) -> Floats:
    """Return the moments (N m) of the solver's section along a path of curvatures (1/m)."""
    impact = replace(paper_impact(), beam=beam)
    grid = Discretisation(rule=rule, points=points)
    cut = section.make_section(case_table(impact, grid, duration=1.0)[0])
    strain, peeq = np.zeros((1, points // 2)), np.zeros((1, points // 2))
    found = []
    for kappa in curvatures:
        moment, _, _ = section.bend(cut, float(kappa), strain, peeq, 0)
        found.append(cut.stiffness * kappa - moment)
    return np.array(found)


def _path() -> Floats:
    """Return the curvatures out, back through zero to the other side, and out, in 240 steps."""
    out = np.linspace(0.0, _TURN, 41)[1:]
    back = np.linspace(_TURN, -_TURN, 101)[1:]
    return np.concatenate([out, back, back[::-1]])


def _rules(name: str, beam: Beam, kappa: Floats) -> Comparison:
    """Compare the worst of all rules with its own fibres."""
    ours, expected = [], []
    for rule in RULES:
        for points in _POINTS:
            ours.append(moments(beam, rule, points, kappa))
            expected.append(bending.path_moments(beam, kappa, *quadrature.rule(rule, points)))
    where = f"{name}; every rule with {', '.join(map(str, _POINTS))} points, its own fibres"
    return curve("moment", where, "N m", np.concatenate(ours), np.concatenate(expected), 1e-12)


def _exact(name: str, beam: Beam, kappa: Floats, ours: Floats) -> Comparison:
    where = f"{name}; {_FINE[1]} Gauss-Legendre points, the exact section"
    return curve("moment", where, "N m", ours, _exact_moments(beam, kappa), 5e-4)


def _exact_moments(beam: Beam, kappa: Floats) -> Floats:
    """Return Masing's closed form or, for isotropic hardening, the moments of 2000 fibres."""
    if beam.material.isotropic_hardening_modulus:
        return bending.path_moments(beam, kappa, *quadrature.rule("legendre", 2000))
    farthest = int(np.argmax(kappa))
    lowest, turn = int(np.argmin(kappa)), float(kappa[farthest])
    return np.concatenate(
        [
            bending.moment(beam, kappa[:farthest]),
            bending.moment_after_turn(beam, turn, kappa[farthest:lowest]),
            -bending.moment_after_turn(beam, turn, -kappa[lowest:]),
        ]
    )


_RATIOS = (10.0, 30.0, 100.0, 300.0)
"""Kinetic energy over the largest elastic energy of the beam."""
_HEAVY = 100.0
_MASSES = (_HEAVY, 20.0, 5.0)
"""Mass of the striker over that of the beam, whose momentum matters more, the lighter: 6 % at 5."""
_MODE_GRID = Discretisation(nodes=101, points=40, rule="layers")
_YIELD_STRESS = 20e6
"""In Pa, so low that both the elastic deflection and the rotation are small."""


def check_rigid_plastic_mode() -> Finding:
    """Compare permanent deflection and duration with the mode, and the approach to it."""
    comparisons: list[Comparison] = []
    for mass in _MASSES:
        comparisons += _far(mass)
    permanents = [_permanent_deflection(_struck(_HEAVY, ratio)) for ratio in _RATIOS]
    for ratio, ours in zip(_RATIOS, permanents, strict=True):
        impact = soft_impact(_HEAVY, ratio)
        where = f"energy ratio {ratio:g}, mass ratio {_HEAVY:g}; mode and elastic bending"
        expected = collapse.elastic_plastic_deflection(impact)
        comparisons.append(relative("permanent deflection", where, "m", ours, expected, 5e-3))
    return Finding(comparisons, [_mode_panel(permanents)])


RIGID_PLASTIC_MODE = Check(
    "rigid_plastic_mode",
    "Rigid-plastic mode",
    "Martin and Symonds 1966; Jones, Structural Impact; impactlab.verification.solutions.collapse",
    check_rigid_plastic_mode,
)


def soft_impact(mass_ratio: float, energy_ratio: float) -> Impact:
    """Return the paper's beam of soft material, struck elastically and without gravity."""
    paper = paper_impact(1.0, "hertz")
    soft = replace(paper.beam.material, yield_stress=_YIELD_STRESS)
    beam = replace(paper.beam, material=soft)
    mass = mass_ratio * beam.mass_per_length * beam.span
    sphere = replace(paper.sphere, mass=mass)
    impact = replace(paper, beam=beam, sphere=sphere, gravity=0.0)
    return replace(impact, velocity=math.sqrt(energy_ratio / collapse.energy_ratio(impact)))


def _struck(mass_ratio: float, energy_ratio: float) -> xr.Dataset:
    """Solve until somewhat after the beam has stopped."""
    impact = soft_impact(mass_ratio, energy_ratio)
    duration = 1.3 * collapse.mode_duration(impact) + 5e-3
    return simulate(impact, _MODE_GRID, duration=duration, samples=4001)


def _far(mass_ratio: float) -> list[Comparison]:
    """Compare with the mode alone, at the largest energy ratio."""
    ratio = max(_RATIOS)
    impact, run = soft_impact(mass_ratio, ratio), _struck(mass_ratio, ratio)
    where = f"energy ratio {ratio:g}, mass ratio {mass_ratio:g}; mode"
    stop = float(run["time"][int(np.argmax(run["midspan_deflection"].values))])
    deflection, time = collapse.mode_deflection(impact), collapse.mode_duration(impact)
    return [
        relative("permanent deflection", where, "m", _permanent_deflection(run), deflection, 1e-2),
        relative("time to the largest deflection", where, "s", stop, time, 1e-2),
    ]


def _permanent_deflection(run: xr.Dataset) -> float:
    """Return the deflection (m) that the plastic strains leave when all vibration has ended.

    Unit-load theorem: the integral of the plastic curvature times half the distance from the
    nearer support.
    """
    _, weights = quadrature.rule(_MODE_GRID.rule, _MODE_GRID.points)
    x, z = run["x"].values, run["z"].values
    curvature = run["plastic_strain"].values @ (weights * z) / (weights @ z**2)
    near = np.minimum(x, x[-1] - x)
    return float(np.trapezoid(0.5 * curvature * near, x))


def _mode_panel(permanents: list[float]) -> Panel:
    """Draw the relative distance from the mode's final deflection."""
    impacts = [soft_impact(_HEAVY, ratio) for ratio in _RATIOS]
    final = np.array([collapse.mode_deflection(impact) for impact in impacts])
    expected = np.array([collapse.elastic_plastic_deflection(impact) for impact in impacts])
    ratios = np.array(_RATIOS)
    return Panel(
        "The rest is elastic: it falls with the energy ratio",
        ("kinetic energy over the beam's elastic capacity", "1"),
        ("shortfall of the permanent deflection from the mode's", "1"),
        [
            Curve("solver", ratios, 1.0 - np.array(permanents) / final),
            Curve("mode and elastic bending", ratios, 1.0 - expected / final, independent=True),
        ],
        log=True,
    )
