"""The beam that is struck."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.checks import instance, positive
from impactlab.model.columns import anywhere
from impactlab.model.material import Material


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A simply supported beam of rectangular section: span, width and depth in m.

    Raises ValueError naming the field when a length is not finite and positive, or when the
    depth is not below the span, or the material is none.
    """

    span: float
    width: float
    depth: float
    material: Material

    def __post_init__(self) -> None:
        instance("Beam", "material", self.material, Material)
        for field in ("span", "width", "depth"):
            positive("Beam", field, getattr(self, field))
        if anywhere(self.depth >= self.span):
            raise ValueError(
                f"Beam.depth = {self.depth!r}: must be below the span ({self.span!r} m)"
            )

    @property
    def mass_per_length(self) -> float:
        """rho A in kg/m."""
        return self.material.density * self.width * self.depth

    @property
    def bending_stiffness(self) -> float:
        """EI in N m2 (exact section, not that of an integration rule)."""
        return self.material.youngs_modulus * self.width * self.depth**3 / 12.0
