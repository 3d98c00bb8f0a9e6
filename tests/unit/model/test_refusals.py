"""Every field of the model is checked when made, and the message names it."""

import re
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest

import impactlab as il
from impactlab.solver import RESISTANCES

IMPACT = il.paper_impact()
PARTS = {
    "Material": IMPACT.beam.material,
    "Sphere": IMPACT.sphere,
    "Beam": IMPACT.beam,
    "Impact": IMPACT,
    "Discretisation": il.Discretisation(),
}
NAN, INFINITE = float("nan"), float("inf")
UNREAL = [0, -1.0, NAN, INFINITE, "1 A", None, True]
NEGATIVE = [-1e-9, NAN, INFINITE, "1 A", None, True]

REFUSED = {
    ("Material", "density"): UNREAL,
    ("Material", "youngs_modulus"): UNREAL,
    ("Material", "yield_stress"): [*UNREAL, 210e9, 1e12],
    ("Material", "poissons_ratio"): [-0.1, 0.5, 1.0, NAN, "0.3 m", None],
    ("Material", "isotropic_hardening_modulus"): NEGATIVE,
    ("Material", "kinematic_hardening_modulus"): NEGATIVE,
    ("Material", "rate_coefficient"): [-1.0, NAN, INFINITE, "1 A", None, True],
    ("Material", "rate_exponent"): [0, 0.99, -5, NAN, INFINITE, "1 A", None, True],
    ("Material", "rate_sensitivity"): [-1.0, NAN, INFINITE, "1 A", None, True],
    ("Material", "reference_rate"): UNREAL,
    ("Material", "flow_law"): ["ludwik", "Linear", "", None, 0],
    ("Sphere", "radius"): UNREAL,
    ("Sphere", "mass"): [0, -1.0, NAN, INFINITE, "1 A", True],
    ("Beam", "span"): UNREAL,
    ("Beam", "width"): UNREAL,
    ("Beam", "depth"): [*UNREAL, 0.78, 1.0],
    ("Beam", "shear_coefficient"): [*(value for value in UNREAL if value is not None), 1.0001],
    ("Beam", "shape"): ["square", "Rectangle", "", None, 0],
    ("Beam", "wall_thickness"): [0, -1.0, NAN, INFINITE, "1 A", True, 1e-3],
    ("Beam", "flange_thickness"): [0, -1.0, NAN, INFINITE, "1 A", True, 1e-3],
    ("Beam", "web_thickness"): [0, -1.0, NAN, INFINITE, "1 A", True, 1e-3],
    ("Beam", "layers"): ["0.5 2 1 1", [(0.5, 2, 1, 1)], "", 5],
    ("Beam", "profile"): ["0 1, 1 1", [(0, 1), (1, 1)], "", 5],
    ("Beam", "support_left"): ["hinged", "Pinned", "", None, 0],
    ("Beam", "support_right"): ["fixed", "Clamped", "", None, 1],
    **{
        ("Beam", f"{kind}stiffness_{side}"): NEGATIVE
        for kind in ("", "rotational_")
        for side in ("left", "right")
    },
    **{("Beam", field): NEGATIVE for field in RESISTANCES},
    ("Impact", "velocity"): UNREAL,
    ("Impact", "gravity"): NEGATIVE,
    ("Impact", "contact"): ["hooke", "Hertz", "", None, 0],
    ("Impact", "beam_model"): ["bernoulli", "Rigid", "spring-mass", "", None, 0],
    ("Impact", "contact_compliance"): ["none", "Beam", "", None, 0],
    ("Impact", "contact_prestress"): ["none", "Bending", "", None, 0],
    ("Impact", "load"): ["patch", "Point", "", None, 0],
    ("Impact", "strike_position"): [0.0, -0.1, 1.0, 1.1, NAN, INFINITE, "1 m", None, True],
    ("Impact", "strike_interval"): [0, -1.0, NAN, INFINITE, "1 A", True],
    ("Impact", "further_spheres"): ["0.25 0 0", "0.25 1 -1", "0.2 1", [{}], "", 5, "0.5 1 0"],
    ("Impact", "strikes"): [0, 1.5, -1, NAN, INFINITE, "2", None, True],
    ("Discretisation", "nodes"): [0, 3, 4, 200, 201.5, -201, NAN, INFINITE, "201", None, True],
    ("Discretisation", "points"): [1, 0, -9, 2.5, NAN, "9", None],
    ("Discretisation", "rule"): ["simpson", "Lobatto", None, 0],
    ("Discretisation", "scheme"): ["newmark", "semi_implicit", "Leapfrog", "", None, 0],
    ("Discretisation", "courant"): [0, -0.5, 1.0001, 2, NAN, INFINITE, "0.9 m", None],
    ("Discretisation", "element_size"): [0, -1e-3, NAN, INFINITE, "1 kg", True],
    ("Discretisation", "elements_per_radius"): [0, -2, NAN, INFINITE, "2 m", True],
}
ALLOWED = {
    ("Material", "poissons_ratio"): [0, 0.0, 0.4999],
    ("Material", "isotropic_hardening_modulus"): [0, 1e12],
    ("Material", "kinematic_hardening_modulus"): [0, 1e12],
    ("Material", "rate_coefficient"): [0, 40.4, 1e9],
    ("Material", "rate_exponent"): [1, 5.0],
    ("Material", "rate_sensitivity"): [0, 0.014],
    ("Material", "reference_rate"): [1e-4, 1],
    ("Material", "flow_law"): ["linear"],
    ("Sphere", "mass"): [None, 1, 1e-9],
    ("Beam", "depth"): [0.7799],
    ("Beam", "support_left"): ["pinned", "clamped", "free"],
    ("Impact", "strike_position"): [1e-9, 0.3, 0.9999],
    ("Impact", "strikes"): [1, 2, 91.0],
    ("Impact", "gravity"): [0, 9.81],
    ("Discretisation", "nodes"): [5, 7, 1201],
    ("Discretisation", "points"): [2, 3, 64],
    ("Discretisation", "courant"): [1, 1.0, 1e-6],
    ("Discretisation", "element_size"): [None, 1e-3],
    ("Discretisation", "elements_per_radius"): [None, 2, 3.5],
    ("Impact", "beam_model"): ["solid"],
}


def pairs(table):
    return [(*place, value) for place, values in table.items() for value in values]


@pytest.mark.parametrize(("part", "field", "value"), pairs(REFUSED))
def test_the_message_names_class_field_and_value(part, field, value):
    with pytest.raises(ValueError, match=rf"^{part}\.{field} = ") as caught:
        replace(PARTS[part], **{field: value})
    assert re.search(
        f"= {re.escape(repr(value))}: (must|'.*' has the wrong dim)", str(caught.value)
    )


@pytest.mark.parametrize(("part", "field", "value"), pairs(ALLOWED))
def test_the_edges_of_what_is_allowed(part, field, value):
    assert getattr(replace(PARTS[part], **{field: value}), field) == value


def test_every_field_is_covered():
    parts = {"material", "sphere", "beam"}
    every = {
        (name, field.name)
        for name, part in PARTS.items()
        for field in fields(part)
        if field.name not in parts
    }
    assert every == set(REFUSED)


@pytest.mark.parametrize(("part", "field"), REFUSED)
def test_what_is_made_stays_as_it_is(part, field):
    with pytest.raises(FrozenInstanceError):
        setattr(PARTS[part], field, getattr(PARTS[part], field))


@pytest.mark.parametrize(
    "value", [None, 0.03, IMPACT, "steel"], ids=["none", "3", "impact", "word"]
)
@pytest.mark.parametrize(
    ("part", "field", "kind"),
    [
        ("Impact", "sphere", "Sphere"),
        ("Impact", "beam", "Beam"),
        ("Beam", "material", "Material"),
        ("Sphere", "material", "Material"),
    ],
)
def test_a_part_is_of_its_class(part, field, kind, value):
    with pytest.raises(ValueError, match=rf"^{part}\.{field} = .*: must be a {kind}$"):
        replace(PARTS[part], **{field: value})


@pytest.mark.parametrize("value", [10**400, -(10**400), 10**5000], ids=["large", "least", "huge"])
def test_a_number_too_large_for_a_float_is_refused(value):
    with pytest.raises(ValueError, match=r"^Material\.density = .* bits: must be a finite number$"):
        replace(PARTS["Material"], density=value)
    with pytest.raises(ValueError, match=r"^Discretisation\.nodes = "):
        replace(PARTS["Discretisation"], nodes=value)


def test_an_array_is_no_name():
    for contact in (np.array(["hertz", "stronge"]), np.array("hertz")):
        with pytest.raises(ValueError, match=r"^Impact\.contact = .*: must be one of"):
            replace(IMPACT, contact=contact)
    # fields go by name
    with pytest.raises(TypeError):
        il.Sphere(0.035, IMPACT.sphere.material)
    # the size of solid elements is said once
    with pytest.raises(ValueError, match=r"elements_per_radius = 2: element_size says it already"):
        il.Discretisation(element_size=1e-3, elements_per_radius=2)
