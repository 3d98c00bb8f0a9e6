"""The beam that is struck."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.checks import anywhere, instance, positive
from impactlab.model.material import Material


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A simply supported beam of rectangular section: span, width and depth in m.

    shear_coefficient: k in Q = k G A times the shear angle, of the Timoshenko beam alone.

    Raises ValueError naming the field when a length is not finite and positive, or when the
    depth is not below the span, the shear coefficient not in (0, 1], or the material is none.
    """

    span: float
    width: float
    depth: float
    material: Material
    shear_coefficient: float = 5.0 / 6.0

    def __post_init__(self) -> None:
        instance("Beam", "material", self.material, Material)
        for field in ("span", "width", "depth"):
            positive("Beam", field, getattr(self, field))
        if anywhere(self.depth >= self.span):
            raise ValueError(
                f"Beam.depth = {self.depth!r}: must be below the span ({self.span!r} m)"
            )
        if anywhere(positive("Beam", "shear_coefficient", self.shear_coefficient) > 1):
            raise ValueError(
                f"Beam.shear_coefficient = {self.shear_coefficient!r}: must be in (0, 1]; "
                "5/6 holds for a rectangle"
            )

    @property
    def mass_per_length(self) -> float:
        """rho A in kg/m."""
        return self.material.density * self.width * self.depth

    @property
    def bending_stiffness(self) -> float:
        """EI in N m2 (exact section, not that of an integration rule)."""
        return self.material.youngs_modulus * self.width * self.depth**3 / 12.0
