"""What a deck is written for."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.checks import instance, positive
from impactlab.model.impact import Impact
from impactlab.reference import hertz
from impactlab.reference.solid.mesh import Mesh

_SAMPLES = 60
"""Intervals in the contact duration of an elastic half-space."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """An impact on its mesh for `duration` (s), with results every `interval` (s).

    plastic: whether the materials yield.

    Raises ValueError naming the field where impact, mesh or a time is none.
    """

    impact: Impact
    mesh: Mesh
    duration: float
    interval: float
    plastic: bool

    def __post_init__(self) -> None:
        instance("deck", "impact", self.impact, Impact)
        instance("deck", "mesh", self.mesh, Mesh)
        positive("deck", "duration", self.duration)
        if positive("deck", "interval", self.interval) > self.duration:
            raise ValueError(
                f"deck.interval = {self.interval!r} s: must not be above the duration "
                f"({self.duration!r} s)"
            )


def usual_interval(impact: Impact, duration: float) -> float:
    """Results often enough to see the contact come and go, in s."""
    contact = hertz.contact_duration(
        impact.sphere.total_mass,
        impact.velocity,
        hertz.effective_modulus(impact),
        hertz.effective_radius(impact),
    )
    return min(contact / _SAMPLES, duration)
