"""The sphere that strikes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from impactlab.model.checks import instance, positive
from impactlab.model.material import Material


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """A solid sphere: radius in m, mass in kg (None: density times volume).

    Raises ValueError naming the field when radius or mass is not finite and positive, or the
    material is none.
    """

    radius: float
    material: Material
    mass: float | None = None

    def __post_init__(self) -> None:
        instance("Sphere", "material", self.material, Material)
        positive("Sphere", "radius", self.radius)
        if self.mass is not None:
            positive("Sphere", "mass", self.mass)

    @property
    def total_mass(self) -> float:
        """Mass in kg: the stated one, else density times volume."""
        if self.mass is not None:
            return self.mass
        # not **3: numpy's power of a column is not Python's to the last bit
        cube = self.radius * self.radius * self.radius
        mass: float = self.material.density * 4.0 / 3.0 * math.pi * cube
        return mass
