"""The metal of a sphere or a beam."""

from dataclasses import dataclass
from typing import Any

from impactlab.model.checks import among, number, one_of, positive, require
from impactlab.model.flow_law import FLOW_LAW_NAMES, FlowLaw
from impactlab.model.quantities import SI, engineering
from impactlab.solver import FLOW_LAWS


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
        Coefficient D of Cowper and Symonds, in 1/s; 0 for a yield stress without their law.
    rate_exponent : Quantity, default 5
        Exponent q of Cowper and Symonds, at least 1.
    rate_sensitivity : Quantity, default 0
        Coefficient C of Johnson and Cook; 0 for a yield stress without their law.
    reference_rate : Quantity, default 1
        Strain rate of Johnson and Cook up to which the yield stress is the static one, in 1/s.
    flow_law : str or FlowLaw, default "linear"
        Hardening of the beam's fibres: "linear", by the moduli, or a registered law, which takes
        the place of the isotropic modulus and of the laws of the strain rate.

    Raises
    ------
    ValueError
        If a value is not physical, or both laws of the strain rate are set; the message names the
        field.

    Notes
    -----
    At the plastic strain rate p' the yield stress is 1 + (p'/D)^(1/q) times the static one, after
    Cowper and Symonds, or 1 + C ln(p'/reference_rate) times after Johnson and Cook, in the beam's
    fibres and its contact (solver/strain_rate.py), and in 3-D finite elements.

    References
    ----------
    Cowper and Symonds (1957), Brown University, Applied Mathematics Report 28 (as remembered).
    Johnson and Cook (1983), 7th International Symposium on Ballistics, 541 (as remembered).

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
    rate_sensitivity: SI[float] = SI("1", 0.0)
    reference_rate: SI[float] = SI("s-1", 1.0)
    flow_law: str = "linear"

    def __post_init__(self) -> None:
        for field in ("density", "youngs_modulus", "yield_stress"):
            positive("Material", field, getattr(self, field))
        for field in ("isotropic_hardening_modulus", "kinematic_hardening_modulus"):
            modulus = number("Material", field, getattr(self, field))
            require(modulus >= 0, "Material", field, modulus, "must not be negative")
        positive("Material", "reference_rate", self.reference_rate)
        for field in ("rate_coefficient", "rate_sensitivity"):
            rate = number("Material", field, getattr(self, field))
            message = "must be above zero, or 0 for no dependence on the strain rate"
            require(rate >= 0, "Material", field, rate, message)
        single = (self.rate_coefficient == 0) | (self.rate_sensitivity == 0)
        message = "is Johnson and Cook's, beside Cowper and Symonds' rate_coefficient: set one to 0"
        require(single, "Material", "rate_sensitivity", self.rate_sensitivity, message)
        law: Any = self.flow_law
        if isinstance(law, FlowLaw):
            object.__setattr__(self, "flow_law", FLOW_LAW_NAMES.registered(law))
        one_of("Material", "flow_law", self.flow_law, FLOW_LAW_NAMES)
        linear = among(self.flow_law, FLOW_LAWS)
        for field in ("isotropic_hardening_modulus", "rate_coefficient", "rate_sensitivity"):
            value = getattr(self, field)
            message = "must be 0 with a flow_law, which states hardening and rate"
            require(linear | (value == 0.0), "Material", field, value, message)
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
