"""Supports, symmetry, gravity and the sphere's velocity: the same in both programs."""

from __future__ import annotations

from collections.abc import Iterator

from impactlab.fem3d.deck import sets
from impactlab.fem3d.deck.case import Case
from impactlab.fem3d.deck.lines import values
from impactlab.fem3d.deck.units import ACCELERATION, VELOCITY


def supports() -> Iterator[str]:
    """Planes of symmetry, and the beam's ends held at mid-depth."""
    yield "*BOUNDARY"
    yield f"{sets.SYMMETRY_X}, 1, 1"
    yield f"{sets.SYMMETRY_Y}, 2, 2"
    yield f"{sets.SUPPORT}, 3, 3"


def start(case: Case) -> Iterator[str]:
    """The sphere moves downwards at first touch."""
    yield "*INITIAL CONDITIONS, TYPE=VELOCITY"
    yield f"{sets.SPHERE_NODES}, 3, {values(-case.impact.velocity * VELOCITY)}"


def gravity(case: Case) -> Iterator[str]:
    """On the sphere alone, as in the beam models."""
    if case.impact.gravity > 0.0:
        yield "*DLOAD"
        yield f"SPHERE, GRAV, {values(case.impact.gravity * ACCELERATION, 0.0, 0.0, -1.0)}"
