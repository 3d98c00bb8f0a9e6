"""An elastic-plastic material with linear isotropic and kinematic hardening."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.checks import anywhere, not_negative, number, positive


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic metal, in SI units.

    density in kg/m3; youngs_modulus, yield_stress and the two hardening moduli in Pa
    (slope of the uniaxial yield stress, or of the back stress, against plastic strain);
    poissons_ratio without unit, 0 <= nu < 0.5. Hardening acts in the beam's fibres only: the
    contact laws know the initial yield stress alone.

    Raises ValueError naming the field when a value is not physical.
    """

    density: float
    youngs_modulus: float
    poissons_ratio: float
    yield_stress: float
    isotropic_hardening_modulus: float = 0.0
    kinematic_hardening_modulus: float = 0.0

    def __post_init__(self) -> None:
        for field in ("density", "youngs_modulus", "yield_stress"):
            positive("Material", field, getattr(self, field))
        for field in ("isotropic_hardening_modulus", "kinematic_hardening_modulus"):
            not_negative("Material", field, getattr(self, field))
        ratio = number("Material", "poissons_ratio", self.poissons_ratio)
        if anywhere(ratio < 0) or anywhere(ratio >= 0.5):
            raise ValueError(
                f"Material.poissons_ratio = {self.poissons_ratio!r}: must be from 0 to below 0.5"
            )
        if anywhere(self.yield_stress >= self.youngs_modulus):
            raise ValueError(
                f"Material.yield_stress = {self.yield_stress!r}: must be below youngs_modulus "
                f"({self.youngs_modulus!r} Pa); are both in Pa?"
            )
