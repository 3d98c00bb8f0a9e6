"""The case table holds every parameter, in SI, with names as numbers."""

import pytest

from impactlab.fem3d.wing import SIZES
from impactlab.model.parameters import PARAMETERS
from impactlab.solver import BEAM_MODELS, LOADS, RULES, SCHEMES, SHAPES, SUPPORTS
from impactlab.solver.contact import LAWS
from impactlab.solver.types import CASE

OF_KERNELS = {
    name: entry for name, entry in PARAMETERS.items() if name not in (*SIZES, "contact_compliance")
}
"""Without those of the 3-D model alone, and that which becomes eight numbers."""
THICKNESSES = [name for name in PARAMETERS if name.endswith("thickness")]
OF_SECTION = {
    "mass_per_length": lambda rho, E, nu, B, H, k: rho * B * H,
    "rotary_inertia": lambda rho, E, nu, B, H, k: rho * B * H**3 / 12,
    "shear_stiffness": lambda rho, E, nu, B, H, k: k * E / (2 + 2 * nu) * B * H,
    "stress_per_moment": lambda rho, E, nu, B, H, k: 6 / (B * H**2),
    "plastic_modulus": lambda rho, E, nu, B, H, k: B * H**2 / 4,
}
DERIVED = (
    *("compliance", "bending_compliance", "axis_compliance", "axis_bending"),
    *("width_stiffness", "width_inertia", "width_lever", "width_twist"),
    *("stress_along", "stress_across", "crowding", "crowding_in_depth", "skin_thickness"),
    *("axis_held_left", "axis_held_right", "further"),
)


def test_fields_are_the_parameters_and_the_duration():
    assert sorted(CASE.names) == sorted([*OF_KERNELS, *OF_SECTION, *DERIVED, "duration"])


def test_a_record_has_every_value_in_its_place(make_case):
    names = {"contact": "hertz", "beam_model": "elastic", "rule": "layers"}
    names |= {"load": "contact_patch", "support_left": "clamped", "support_right": "free"}
    numbers = {
        name: 0.5 + number / 110
        for number, (name, entry) in enumerate(OF_KERNELS.items())
        if not entry.choices and not entry.is_integer and "poisson" not in name
        if name not in THICKNESSES and not entry.any_word
    }
    ratios = {"sphere_poissons_ratio": 0.1, "beam_poissons_ratio": 0.2, "damping_ratio": 0.0}
    moduli = {"sphere_youngs_modulus": 1e9, "beam_youngs_modulus": 2e9, "beam_span": 9.0}
    moduli |= {"beam_rate_exponent": 4.0, "beam_rate_sensitivity": 0.0}
    values = numbers | ratios | moduli | {"nodes": 19, "points": 3, "strike_position": 5 / 18}
    values |= {"strikes": 2, "strike_interval": 0.8}
    case = make_case(duration=0.7, **values, **names)
    numbers_of_names = {
        "contact": LAWS.index("hertz"),
        "beam_model": BEAM_MODELS.index("elastic"),
        "load": LOADS.index("contact_patch"),
        "contact_prestress": 0,
        "rule": RULES.index("layers"),
        "scheme": SCHEMES.index("leapfrog"),
        "beam_shape": SHAPES.index("rectangle"),
        "beam_flow_law": 0,
        "support_left": SUPPORTS.index("clamped"),
        "support_right": SUPPORTS.index("free"),
    }
    expected = values | numbers_of_names | {"duration": 0.7}
    expected |= dict.fromkeys((*DERIVED, *THICKNESSES), 0.0) | {"axis_held_left": 1}
    lists = {"beam_profile", "beam_layers", "further_spheres"}
    assert not any(case[name].any() for name in lists)
    names = {*CASE.names} - {*OF_SECTION} - lists
    assert {name: case[name] for name in names} == expected
    beam = [values[f"beam_{name}"] for name in ("density", "youngs_modulus", "poissons_ratio")]
    sizes = [values[name] for name in ("beam_width", "beam_depth", "shear_coefficient")]
    for name, formula in OF_SECTION.items():
        assert case[name] == pytest.approx(formula(*beam, *sizes), rel=1e-14)


def test_the_spheres_mass_is_the_stated_one_or_follows_from_density(make_case):
    assert make_case(sphere_mass=2.0).sphere_mass == 2.0
    assert make_case(sphere_radius=0.1).sphere_mass == pytest.approx(32.6726, rel=1e-5)
