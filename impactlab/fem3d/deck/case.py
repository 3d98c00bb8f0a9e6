"""A deck's case and flavour, its units and numbers, and the cards that both programs share."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from impactlab.fem3d.solver.mesh import Mesh
from impactlab.model.checks import instance, positive
from impactlab.model.impact import Impact, Material
from impactlab.verification.solutions import hertz

NAMES = "N, mm, t, s (hence MPa, mJ, t/mm3, mm/s)"
LENGTH = 1e3
"""mm per m."""
VELOCITY = 1e3
"""mm/s per m/s."""
ACCELERATION = 1e3
"""mm/s2 per m/s2."""
STRESS = 1e-6
"""MPa per Pa."""
DENSITY = 1e-12
"""t/mm3 per kg/m3."""


def values(*entries: float) -> str:
    """Return one data line."""
    return ", ".join(f"{entry:.9g}" for entry in entries)


_SAME = 1e-9
"""Relative difference of lengths that are the same."""
_SAMPLES = 60
"""Intervals in the contact duration of an elastic half-space."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """An impact on its mesh for `duration` (s).

    interval: time between results in s (None: a 60th of the contact duration of an elastic
    half-space). plastic: whether the materials yield.

    Raises ValueError naming the field where impact, mesh or a time is none, and when the mesh is
    that of other bodies.
    """

    impact: Impact
    mesh: Mesh
    duration: float
    interval: float | None
    plastic: bool

    def __post_init__(self) -> None:
        instance("deck", "impact", self.impact, Impact)
        instance("deck", "mesh", self.mesh, Mesh)
        positive("deck", "duration", self.duration)
        if self.interval is not None:
            positive("deck", "interval", self.interval)
            if self.interval > self.duration:
                raise ValueError(
                    f"deck.interval = {self.interval!r} s: must not be above the duration "
                    f"({self.duration!r} s)"
                )
        beam, nodes = self.impact.beam, self.mesh.nodes
        for name, meshed, wanted in (
            ("beam's span", 2.0 * nodes[self.mesh.support, 0].max(), beam.span),
            ("beam's width", 2.0 * nodes[self.mesh.support, 1].max(), beam.width),
            ("beam's depth", -nodes[:, 2].min(), beam.depth),
            ("sphere's radius", 0.5 * nodes[:, 2].max(), self.impact.sphere.radius),
        ):
            if not math.isclose(meshed, wanted, rel_tol=_SAME):
                raise ValueError(
                    f"deck.mesh: the {name} is {meshed:.9g} m in the mesh and {wanted:.9g} m in "
                    "the impact: make the mesh from this impact (quarter_mesh)"
                )

    @property
    def time_between(self) -> float:
        """Return the time between results, in s."""
        if self.interval is not None:
            return self.interval
        contact = hertz.contact_duration(*hertz.arguments(self.impact))
        return min(contact / _SAMPLES, self.duration)


@dataclass(frozen=True, kw_only=True)
class Flavour:
    """One program's part of a deck.

    elements: its types, fully integrated (True) and not. hardening, sections, contact and step
    give lines: plasticity of a material, section assignments, what the model says of contact, and
    the step from *STEP to *END STEP. limits: what a user has to know, a sentence each.
    """

    program: str
    elements: Mapping[bool, str]
    hardening: Callable[[Material], Iterable[str]]
    sections: Callable[[Case], Iterable[str]]
    contact: Callable[[Case], Iterable[str]]
    step: Callable[[Case], Iterable[str]]
    limits: tuple[str, ...]


_LONGEST = 10.0
"""Plastic strain at which the tables end; both programs keep the stress from there on."""


def curve(material: Material, modulus: float) -> Iterator[str]:
    """Yield stress against equivalent plastic strain, rising by `modulus` (Pa): one point if 0."""
    yield values(material.yield_stress * STRESS, 0.0)
    if modulus > 0.0:
        yield values((material.yield_stress + modulus * _LONGEST) * STRESS, _LONGEST)


def gravity(case: Case) -> Iterator[str]:
    """Yield gravity on the sphere alone, as in the beam models."""
    if case.impact.gravity > 0.0:
        yield "*DLOAD"
        yield f"SPHERE, GRAV, {values(case.impact.gravity * ACCELERATION, 0.0, 0.0, -1.0)}"
