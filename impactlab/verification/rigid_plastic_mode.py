"""A heavy, slow striker on a soft beam: one plastic hinge takes all of the energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, relative
from impactlab.verification.solutions import quadrature, rigid_plastic

TITLE = "Rigid-plastic mode"
SOURCE = (
    "Martin and Symonds 1966; Jones, Structural Impact; "
    "impactlab.verification.solutions.rigid_plastic"
)
_RATIOS = (10.0, 30.0, 100.0, 300.0)
"""Kinetic energy over the elastic energy that the beam can store."""
_HEAVY = 100.0
_MASSES = (_HEAVY, 20.0, 5.0)
"""Striker over beam. The lighter, the more the momentum that the beam takes matters: 6 % at 5."""
_GRID = Discretisation(nodes=101, points=40, rule="layers")
_YIELD_STRESS = 20e6
"""In Pa: so low that the elastic deflection is small while the rotation is, too."""


def check() -> Finding:
    """What is left and how long it takes, where the mode holds; how it is approached."""
    comparisons: list[Comparison] = []
    for mass in _MASSES:
        comparisons += _far(mass)
    permanents = [_permanent(_struck(_HEAVY, ratio)) for ratio in _RATIOS]
    for ratio, ours in zip(_RATIOS, permanents, strict=True):
        impact = soft_impact(_HEAVY, ratio)
        where = f"energy ratio {ratio:g}, mass ratio {_HEAVY:g}; mode and elastic bending"
        expected = rigid_plastic.elastic_plastic_deflection(impact)
        comparisons.append(relative("permanent deflection", where, "m", ours, expected, 5e-3))
    return Finding(comparisons, [_panel(permanents)])


def soft_impact(mass_ratio: float, energy_ratio: float) -> Impact:
    """The paper's beam of soft material, struck elastically and without gravity."""
    paper = paper_impact(1.0, "hertz")
    soft = replace(paper.beam.material, yield_stress=_YIELD_STRESS)
    beam = replace(paper.beam, material=soft)
    mass = mass_ratio * beam.mass_per_length * beam.span
    sphere = replace(paper.sphere, mass=mass)
    impact = replace(paper, beam=beam, sphere=sphere, gravity=0.0)
    return replace(impact, velocity=math.sqrt(energy_ratio / rigid_plastic.energy_ratio(impact)))


def _struck(mass_ratio: float, energy_ratio: float) -> xr.Dataset:
    """The run, to somewhat after the beam has stopped."""
    impact = soft_impact(mass_ratio, energy_ratio)
    duration = 1.3 * rigid_plastic.duration(impact) + 5e-3
    return simulate(impact, _GRID, duration=duration, samples=4001)


def _far(mass_ratio: float) -> list[Comparison]:
    """Against the mode alone, at the largest energy ratio."""
    ratio = max(_RATIOS)
    impact, run = soft_impact(mass_ratio, ratio), _struck(mass_ratio, ratio)
    where = f"energy ratio {ratio:g}, mass ratio {mass_ratio:g}; mode"
    stop = float(run["time"][int(np.argmax(run["midspan_deflection"].values))])
    deflection, time = rigid_plastic.final_deflection(impact), rigid_plastic.duration(impact)
    return [
        relative("permanent deflection", where, "m", _permanent(run), deflection, 1e-2),
        relative("time to the largest deflection", where, "s", stop, time, 1e-2),
    ]


def _permanent(run: xr.Dataset) -> float:
    """Deflection (m) that the plastic strains leave when nothing swings any more.

    Unit-load theorem: the integral of the plastic curvature times half the distance from the
    nearer support.
    """
    _, weights = quadrature.rule(_GRID.rule, _GRID.points)
    x, z = run["x"].values, run["z"].values
    curvature = run["plastic_strain"].values @ (weights * z) / (weights @ z**2)
    near = np.minimum(x, x[-1] - x)
    return float(np.trapezoid(0.5 * curvature * near, x))


def _panel(permanents: list[float]) -> Panel:
    """Relative distance from the mode's final deflection."""
    impacts = [soft_impact(_HEAVY, ratio) for ratio in _RATIOS]
    final = np.array([rigid_plastic.final_deflection(impact) for impact in impacts])
    expected = np.array([rigid_plastic.elastic_plastic_deflection(impact) for impact in impacts])
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
