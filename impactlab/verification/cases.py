"""Impacts that more than one check uses."""

from __future__ import annotations

from dataclasses import replace

from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact


def with_beam_material(impact: Impact, **changes: float) -> Impact:
    """`impact` on a beam of another material, its fields as in Material."""
    material = replace(impact.beam.material, **changes)
    return replace(impact, beam=replace(impact.beam, material=material))


def elastic(impact: Impact) -> Impact:
    """`impact` on a beam that never yields, under Hertz contact.

    The yield stress is raised to a tenth of Young's modulus: a strain of 0.1 is out of reach.
    """
    beyond = 0.1 * impact.beam.material.youngs_modulus
    unyielding = with_beam_material(impact, yield_stress=beyond)
    return replace(unyielding, contact="hertz")


def rigid_backed(velocity: float, contact: str) -> Impact:
    """The paper's sphere on a beam of enormous mass (E* as it is), without gravity."""
    impact = paper_impact(velocity, contact)
    return replace(with_beam_material(impact, density=7.8e9), gravity=0.0)
