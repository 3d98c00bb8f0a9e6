"""The flat table of parameters leads to every field and back."""

from dataclasses import fields, is_dataclass

import pytest
from shapes import parameters_of

import impactlab as il
from impactlab.model import flow_law
from impactlab.model.flow_law import FlowLaw
from impactlab.model.own_law import adopt
from impactlab.model.parameters import PARAMETERS, flatten, with_values

BASE = (il.paper_impact(), il.Discretisation())
OTHER_NAMES = {
    "contact": "hertz",
    "beam_model": "elastic",
    "contact_compliance": "beam",
    "contact_prestress": "bending",
    "load": "contact_patch",
    "support_left": "clamped",
    "support_right": "free",
    "beam_shape": "tube",
    "beam_flow_law": "other_flow",
    "rule": "layers",
    "scheme": "modal",
}
OTHER_COUNTS = {"strikes": 91, "nodes": 55, "points": 6}
STATED = {"sphere_mass": 2.5, "element_size": 2e-3, "elements_per_radius": 3.0}
STATED |= {"shear_coefficient": 0.7, "beam_wall_thickness": 3e-3}
STATED |= {"strike_interval": 0.05, "further_spheres": "0.25 3.0 0.0005"}
STATED |= {"beam_profile": "0.0 0.5, 1.0 1.0"}
STATED |= {"beam_layers": "0.5 70000000000.0 200000000.0 2700.0"}
STATED |= {"beam_flange_thickness": 3e-3, "beam_web_thickness": 1e-3}
"""What the base leaves open."""
HARDENING = {"beam_isotropic_hardening_modulus": 2e9, "beam_kinematic_hardening_modulus": 3e9}
HARDENING |= {"beam_rate_coefficient": 40.4, "beam_rate_exponent": 4.0}
HARDENING |= {"beam_rate_sensitivity": 0.02, "beam_reference_rate": 2.0}
HARDENING |= {"beam_flow_law": "other_flow"}
HARDENING |= {"mass_damping": 9.0, "stiffness_damping": 1e-6, "damping_ratio": 0.01}
HARDENING |= {"foundation_stiffness": 1e6}
HARDENING |= {
    f"{kind}stiffness_{side}": 1e6 for kind in ("", "rotational_") for side in ("left", "right")
}


def another(name):
    """A value that the base does not have."""
    given = OTHER_NAMES | OTHER_COUNTS | HARDENING | STATED
    return given[name] if name in given else 0.9 * flatten(*BASE)[name]


OTHERS = {name: another(name) for name in PARAMETERS}
TOGETHER = {
    name: value
    for name, value in OTHERS.items()
    if name not in ("elements_per_radius", "beam_profile", "beam_layers", "further_spheres")
    and "thickness" not in name
} | {"beam_shape": "rectangle"}
TOGETHER |= {"beam_rate_sensitivity": 0.0, "strikes": 1, "beam_flow_law": "linear"}
"""Without what contradicts another."""


@pytest.fixture(scope="module", autouse=True)
def _other_flow():
    """Let the session know another flow law than the built-in one."""
    adopt(FlowLaw(name="other_flow", flow_stress=lambda p, rate, E, S_y: S_y + 1e9 * p))
    yield
    del flow_law._NAMED["other_flow"]


def follow(impact, discretisation, path):
    """The field at the end of a path, by attribute."""
    node = {"impact": impact, "discretisation": discretisation}[path[0]]
    for part in path[1:]:
        node = getattr(node, part)
    return node


def leaves(node, path):
    """Paths of all fields that are not dataclasses themselves."""
    for field in fields(node):
        value = getattr(node, field.name)
        if is_dataclass(value):
            yield from leaves(value, (*path, field.name))
        else:
            yield (*path, field.name)


def test_the_table_has_every_field_once():
    impact, discretisation = BASE
    every = [*leaves(impact, ("impact",)), *leaves(discretisation, ("discretisation",))]
    # the sphere does not harden: contact knows the initial yield stress alone
    unused = {("impact", "sphere", "material", name.removeprefix("beam_")) for name in HARDENING}
    assert sorted(entry.path for entry in PARAMETERS.values()) == sorted(set(every) - unused)
    # flatten gives the papers values
    values = flatten(*BASE)
    assert values["velocity"] == 0.99
    assert values["beam_depth"] == 0.0278
    assert values["sphere_youngs_modulus"] == 208e9
    assert values["beam_youngs_modulus"] == 210e9
    assert values["rule"] == "lobatto"
    assert set(PARAMETERS) - set(values) == set(STATED)


@pytest.mark.parametrize("name", PARAMETERS)
def test_one_value_changes_its_own_field_alone(name):
    base = BASE
    if name in ("beam_profile", "beam_layers"):
        shape = "profile" if name == "beam_profile" else "laminate"
        base = with_values(*BASE, parameters_of(shape))
    if "shape" in name or "thickness" in name:
        shape = "i" if name in ("beam_flange_thickness", "beam_web_thickness") else "box"
        base = with_values(*BASE, parameters_of(shape) | {"beam_width": 0.03})
    impact, discretisation = with_values(*base, {name: OTHERS[name]})
    assert follow(impact, discretisation, PARAMETERS[name].path) == OTHERS[name]
    assert flatten(impact, discretisation) == flatten(*base) | {name: OTHERS[name]}
    assert flatten(*base).get(name) != OTHERS[name]


def test_all_values_at_once_come_back():
    changed = with_values(*BASE, TOGETHER)
    assert flatten(*changed) == TOGETHER
    back = flatten(*with_values(*changed, flatten(*BASE)))
    stated = {name: STATED[name] for name in TOGETHER if name in STATED}
    assert back == flatten(*BASE) | stated  # what was stated stays stated
    # nothing changes nothing
    assert with_values(*BASE, {}) == BASE
    # Neither alone would pass: the depth above the old span, the yield stress above the old E.
    impact, _ = with_values(*BASE, {"beam_depth": 1.0, "beam_span": 5.0})
    assert (impact.beam.depth, impact.beam.span) == (1.0, 5.0)
    impact, _ = with_values(*BASE, {"beam_yield_stress": 3e11, "beam_youngs_modulus": 4e11})
    assert impact.beam.material.yield_stress == 3e11


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"velocty": 1.0}, r"'velocty'; did you mean 'velocity'\? choose from velocity, .*courant"),
        ({"velocity": -1.0}, r"Impact\.velocity = -1\.0"),
        ({"beam_density": 0.0}, r"Material\.density = 0\.0"),
        ({"nodes": 100}, r"Discretisation\.nodes = 100"),
        ({"rule": "simpson"}, r"Discretisation\.rule = 'simpson'"),
        ({"sphere_mass": 0.0}, r"Sphere\.mass = 0\.0"),
    ],
)
def test_a_wrong_value_is_named(values, message):
    with pytest.raises(ValueError, match=message):
        with_values(*BASE, values)


@pytest.mark.parametrize("entry", PARAMETERS.values(), ids=PARAMETERS)
def test_entries_describe_themselves(entry):
    assert PARAMETERS[entry.name] is entry
    assert entry.units
    assert entry.long_name
    value = OTHERS[entry.name]
    assert (bool(entry.choices) or entry.any_word) == isinstance(value, str)
    assert not entry.choices or value in entry.choices
    assert entry.is_integer == isinstance(value, int)
