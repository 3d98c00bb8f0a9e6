"""The metal of a sphere or a beam."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.checks import number, positive, require
from impactlab.model.quantities import SI, engineering


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic metal with linear isotropic and kinematic hardening.

    Hardening acts in the beam's fibres and in the contact law `finite_element`; the other laws know
    the initial yield stress alone.

    Parameters
    ----------
    density : Quantity
        Density, in kg/m3.
    youngs_modulus : Quantity
        Young's modulus, in Pa.
    poissons_ratio : Quantity
        Poisson's ratio nu, 0 <= nu < 0.5.
    yield_stress : Quantity
        Initial yield stress, in Pa.
    isotropic_hardening_modulus : Quantity, default 0
        Slope of the uniaxial yield stress against plastic strain, in Pa.
    kinematic_hardening_modulus : Quantity, default 0
        Slope of the back stress against plastic strain, in Pa.
    rate_coefficient : Quantity, default 0
        Coefficient D, in 1/s; 0 stands for a yield stress that does not depend on the strain rate.
    rate_exponent : Quantity, default 5
        Exponent q, at least 1.

    Raises
    ------
    ValueError
        If a value is not physical; the message names the field.

    Notes
    -----
    At the plastic strain rate p' the yield stress is 1 + (p'/D)^(1/q) times the static one, in the
    beam's fibres and its contact (solver/strain_rate.py).

    References
    ----------
    Cowper and Symonds (1957), Brown University, Applied Mathematics Report 28 (as remembered).

    Examples
    --------
    >>> steel = il.Material(
    ...     density="7.8 g/cm3", youngs_modulus="210 GPa", poissons_ratio=0.3, yield_stress=345e6)
    >>> steel.density, steel.yield_stress
    (7800.0, 345000000.0)
    """

    density: SI[float] = SI("kg m-3")
    youngs_modulus: SI[float] = SI("Pa")
    poissons_ratio: SI[float] = SI("1")
    yield_stress: SI[float] = SI("Pa")
    isotropic_hardening_modulus: SI[float] = SI("Pa", 0.0)
    kinematic_hardening_modulus: SI[float] = SI("Pa", 0.0)
    rate_coefficient: SI[float] = SI("s-1", 0.0)
    rate_exponent: SI[float] = SI("1", 5.0)

    def __post_init__(self) -> None:
        for field in ("density", "youngs_modulus", "yield_stress"):
            positive("Material", field, getattr(self, field))
        for field in ("isotropic_hardening_modulus", "kinematic_hardening_modulus"):
            modulus = number("Material", field, getattr(self, field))
            require(modulus >= 0, "Material", field, modulus, "must not be negative")
        rate = number("Material", "rate_coefficient", self.rate_coefficient)
        message = "must be above zero, or 0 for no dependence on the strain rate"
        require(rate >= 0, "Material", "rate_coefficient", self.rate_coefficient, message)
        exponent = number("Material", "rate_exponent", self.rate_exponent)
        message = "must be at least 1"
        require(exponent >= 1, "Material", "rate_exponent", self.rate_exponent, message)
        ratio = number("Material", "poissons_ratio", self.poissons_ratio)
        sound = (ratio >= 0) & (ratio < 0.5)
        require(sound, "Material", "poissons_ratio", ratio, "must be from 0 to below 0.5")
        stiffness = self.youngs_modulus  # a column holds many
        amount = engineering(stiffness, "Pa") if isinstance(stiffness, float) else "of the run"
        require(
            self.yield_stress < self.youngs_modulus,
            "Material",
            "yield_stress",
            self.yield_stress,
            f"must be below youngs_modulus ({amount}); are both in Pa?",
        )
