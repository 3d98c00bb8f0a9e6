"""Moment against curvature: loading, unloading, and loading the other way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from impactlab.model.beam import Beam
from impactlab.model.discretisation import Discretisation
from impactlab.model.paper import paper_impact
from impactlab.simulate import case_table
from impactlab.solver import RULES, section
from impactlab.verification.finding import Comparison, Curve, Finding, Floats, Panel, curve
from impactlab.verification.solutions import bending, cyclic, quadrature

TITLE = "Moment and curvature"
SOURCE = "Masing 1926; stresses clipped fibre by fibre in impactlab.verification.solutions.cyclic"
_HARDENING = {
    "perfectly plastic": {},
    "isotropic 10 GPa": {"isotropic_hardening_modulus": 10e9},
    "kinematic 10 GPa": {"kinematic_hardening_modulus": 10e9},
}
_POINTS = (2, 3, 4, 9, 21)
_FINE = ("legendre", 100)
_TURN = 6.0
"""Over the curvature at first yield."""


def check() -> Finding:
    """Two loops of each hardening: every rule against its own fibres, a fine one against M."""
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


def moments(beam: Beam, rule: str, points: int, curvatures: Floats) -> Floats:
    """Moments (N m, sign of the curvature) of the solver's section along a path (1/m)."""
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
    """Out, back through zero to the other side, and out again, in 240 steps."""
    out = np.linspace(0.0, _TURN, 41)[1:]
    back = np.linspace(_TURN, -_TURN, 101)[1:]
    return np.concatenate([out, back, back[::-1]])


def _rules(name: str, beam: Beam, kappa: Floats) -> Comparison:
    """All rules at once: the worst one counts."""
    ours, expected = [], []
    for rule in RULES:
        for points in _POINTS:
            ours.append(moments(beam, rule, points, kappa))
            expected.append(cyclic.rule_moments(beam, kappa, *quadrature.rule(rule, points)))
    where = f"{name}; every rule with {', '.join(map(str, _POINTS))} points, its own fibres"
    return curve("moment", where, "N m", np.concatenate(ours), np.concatenate(expected), 1e-12)


def _exact(name: str, beam: Beam, kappa: Floats, ours: Floats) -> Comparison:
    where = f"{name}; {_FINE[1]} Gauss-Legendre points, the exact section"
    return curve("moment", where, "N m", ours, _exact_moments(beam, kappa), 5e-4)


def _exact_moments(beam: Beam, kappa: Floats) -> Floats:
    """Masing's closed form; with isotropic hardening, which he does not cover, 2000 fibres."""
    if beam.material.isotropic_hardening_modulus:
        return cyclic.rule_moments(beam, kappa, *quadrature.rule("legendre", 2000))
    farthest = int(np.argmax(kappa))
    lowest, turn = int(np.argmin(kappa)), float(kappa[farthest])
    return np.concatenate(
        [
            bending.moment(beam, kappa[:farthest]),
            cyclic.moment_after_turn(beam, turn, kappa[farthest:lowest]),
            -cyclic.moment_after_turn(beam, turn, -kappa[lowest:]),
        ]
    )
