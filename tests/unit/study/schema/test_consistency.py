"""Contradictions between the sections of a study of impacts."""

import json

import numpy as np
import pytest

from impactlab.analysis import ANALYSES
from impactlab.methods import NO_DISTRIBUTION
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import flatten
from impactlab.study.design import design
from impactlab.study.solvers.kernels import SOLVER


def test_more_runs_than_possible_are_refused(refused, grid, sample):
    many = {"start": 1, "stop": 2, "number": 10_000}
    few = {"start": 0.7, "stop": 0.8, "number": 100}
    varied = {"sampling.parameters": {"velocity": many, "gravity": many, "beam_span": few}}
    refused(grid(varied), "sampling", "10,000,000,000 runs")
    refused(sample({"sampling.base_samples": 2**29}), "sampling", f"{2**29 * 6:,} runs")


BOX = {"shape": "box", "width": "27.8 mm", "wall_thickness": "4 mm"}


@pytest.mark.parametrize(
    ("name", "value", "beam"),
    [
        *(
            (name, flatten(paper_impact(), Discretisation())[name], {})
            for name in ("nodes", "points", "rule", "beam_span", "beam_depth")
        ),
        ("beam_wall_thickness", 0.004, BOX),
        ("beam_shape", "tube", BOX),
        ("beam_width", 0.0278, BOX),
    ],
)
def test_profiles_need_one_mesh_and_section(refused, read, grid, name, value, beam):
    varied = {"sampling.parameters": {name: [value]}, "impact.beam": beam}
    text = grid(varied | {"store.profiles": True})
    refused(text, f"sampling.parameters.{name}", "would differ between runs")
    read(grid(varied | {"store.profiles": False}))


@pytest.mark.parametrize(
    ("shape", "varied", "message"),
    [
        (
            {"shape": "box"},
            {"velocity": [1]},
            "must be stated, as '4 mm' is: shape = 'box' needs it",
        ),
        ({}, {"beam_wall_thickness": [0.002]}, "must be left out: shape = 'rectangle' has none"),
        ({}, {"beam_shape": ["box"]}, "beam_wall_thickness must be stated"),
        (
            {"shape": "box", "wall_thickness": 0.002},
            {"beam_wall_thickness": [0.002, 0.02]},
            "beam_wall_thickness = 20 mm: beam_wall_thickness must be below half of width",
        ),
    ],
)
def test_sizes_that_make_no_section(refused, grid, shape, varied, message):
    name = next(iter(varied))
    key = "impact.beam.wall_thickness" if name == "velocity" else f"sampling.parameters.{name}"
    refused(grid({"impact.beam": shape, "sampling.parameters": varied}), key, message)


@pytest.mark.parametrize(("name", "value"), [("sphere_radius", 0.02), ("sphere_density", 5000)])
def test_a_stated_mass_leaves_no_say_to_density_and_radius(refused, read, grid, name, value):
    varied = {"sampling.parameters": {name: [value]}}
    text = grid(varied | {"impact.sphere.mass": "1.4 kg"})
    refused(text, f"sampling.parameters.{name}", "set impact.sphere.mass: null")
    assert read(grid(varied | {"impact.sphere.mass": None})).impact.sphere.mass is None


def test_a_varied_mass_leaves_no_say_to_the_density(refused, read, grid):
    text = grid({"sampling.parameters": {"sphere_mass": [1], "sphere_density": [5000]}})
    refused(text, "sampling.parameters.sphere_density", "has no effect")
    both = {"sampling.parameters": {"sphere_mass": [1], "sphere_radius": [0.02]}}
    read(grid(both))
    read(grid(both | {"impact.sphere.mass": "1.4 kg"}))


def test_combinations_in_a_grid_are_checked_and_only_they_count(refused, read, grid):
    stiff = {"beam_youngs_modulus": [1e9, 2e9], "beam_yield_stress": [1e8, 1.5e9]}
    refused(
        grid({"sampling.parameters": stiff}),
        "sampling.parameters.beam_yield_stress",
        "beam_youngs_modulus = 1 GPa",
        "must be below youngs_modulus",
    )
    soft = {"beam_youngs_modulus": [1e8, 2e8], "beam_yield_stress": [1e6, 2e6]}
    hard = {"beam_youngs_modulus": [1e12], "beam_yield_stress": [3e11]}
    for values in (soft, hard):  # values of which one alone would contradict the base
        read(grid({"sampling.parameters": values}))


def test_the_bounds_of_a_sample_are_checked_against_the_rest(refused, read, sample):
    key = "sampling.parameters.beam_depth"
    wide = {key: {"distribution": "uniform", "low": 0.1, "high": 0.9}}
    refused(sample(wide), key, "must be below the span (0.78 m)")
    read(sample(wide | {"impact.beam.span": 1}))


def test_contradictions_are_found_beside_mistakes_elsewhere(problems, grid):
    parameters = "sampling.parameters"
    changes = {"bogus": 1, "impact.sphere.mass": "1.4 kg", "store.profiles": True}
    text = grid(changes | {parameters: {"sphere_radius": [0.02], "nodes": [11, 21]}})
    expected = {"bogus", f"{parameters}.sphere_radius", f"{parameters}.nodes"}
    assert {key for key, _ in problems(text)} == expected


def test_a_broken_section_brings_no_contradictions(problems, grid):
    text = grid({"impact": "x", "sampling.parameters": {"beam_depth": [0.9]}})
    assert [key for key, _ in problems(text)] == ["impact"]


@pytest.mark.parametrize("name", list(ANALYSES))
def test_an_analysis_asked_for_by_name_must_be_possible(refused, grid, name):
    refused(grid({"analyses": [name]}), "analyses", name)


def test_possible_analyses_are_accepted(read, grid, sample):
    assert read(grid({"analyses": "all"})).analyses
    assert read(sample({"analyses": ["sensitivity"]})).analyses == ("sensitivity",)
    several = {"nodes": [11, 21, 41], "courant": [0.2, 0.4, 0.8], "points": [3, 5]}
    several |= {"beam_model": ["solid"], "element_size": ["1 mm", "2 mm", "3 mm"]}
    asked = {"analyses": [entry for entry in ANALYSES if entry.startswith("convergence")]}
    asked |= {"responses": ["peak_force"]}
    read(grid({"sampling.parameters": several} | asked))


def test_indices_over_time_need_stored_histories(refused, read, sample):
    wanted = {"analyses": ["sensitivity_over_time"]}
    refused(sample(wanted), "analyses", "store: {histories: true}")
    assert read(sample(wanted | {"store.histories": True})).store.histories


@pytest.mark.parametrize("method", NO_DISTRIBUTION)
def test_limits_need_runs_that_are_draws(refused, sampled, grid, method):
    number = {"morris": {"trajectories": 8}, "fast": {"samples": 1188}}
    limits = {"limits": {"peak_force": "9 kN"}}
    study = json.loads(grid(limits) if method == "grid" else sampled(method, **number[method]))
    refused(json.dumps(study | limits), "limits", NO_DISTRIBUTION[method], "use sobol")


def test_limits_are_of_responses_of_the_study_in_their_units(refused, read, sample):
    asked = {"responses": ["peak_force", "restitution"]}
    study = read(sample(asked | {"limits": {"restitution": "30 %", "peak_force": "9 kN"}}))
    assert study.limits == {"restitution": 0.3, "peak_force": 9000.0}
    attrs = design(study).attrs
    assert dict(zip(attrs["limited"], attrs["limits"], strict=True)) == study.limits
    wrong = [
        ("peak_force", "9 mm", "wrong dimension"),
        ("impulse", 1, "choose from peak_force"),
        ("peak_forces", 1, "did you mean 'peak_force'"),
        ("restitution", float("nan"), "finite"),
    ]
    for name, limit, reason in wrong:
        refused(sample(asked | {"limits": {name: limit}}), f"limits.{name}", reason)
    text = sample({"limits": {"impulse": 1}, "analyses": ["sensitivity"]})
    refused(text, "limits", "list it in analyses")


SOLID = {
    "sampling.parameters": {"beam_model": ["timoshenko", "solid"]},
    "discretisation": {"element_size": "2 mm"},
    "responses": ["peak_force", "maximum_deflection"],
}


def test_a_study_of_both_is_of_the_witness(read, grid):
    study = read(grid(SOLID))
    assert study.discretisation.element_size == 2e-3
    assert design(study).attrs["solver"] == "witness"
    assert design(study)["element_size"].item() == 2e-3
    plain = design(read(grid({"sampling.parameters": {"beam_model": ["timoshenko"]}})))
    assert plain.attrs["solver"] == "impact"
    assert "element_size" not in plain.coords


@pytest.mark.parametrize(
    ("name", "values", "read_as"),
    [("element_size", ["2 mm", 1e-3], (2e-3, 1e-3)), ("elements_per_radius", [2, 4.5], (2.0, 4.5))],
)
def test_sizes_can_be_varied(read, grid, name, values, read_as):
    several = {"beam_model": ["solid"], name: values}
    study = read(grid(SOLID | {"sampling.parameters": several, "discretisation": {}}))
    assert study.sampling.parameters[name] == read_as


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"discretisation": {"nodes": 51}}, "discretisation.element_size", "is required"),
        ({"responses": "all"}, "responses", "contact_dissipation is not available with"),
        ({"store": {"profiles": True}}, "store.profiles", "must be false"),
        ({"discretisation": "auto"}, "discretisation.auto", "is not possible with"),
        (
            {"sampling.parameters": {"velocity": [1.0]}},
            "discretisation.element_size",
            "has no effect without beam_model: solid",
        ),
        (
            {"sampling.parameters": {"element_size": [1e-3]}, "discretisation": {}},
            "sampling.parameters.element_size",
            "has no effect without beam_model: solid",
        ),
        ({"discretisation": {"element_size": 0}}, "discretisation.element_size", "above zero"),
        (
            {"sampling.parameters": {"beam_model": ["solid"], "elements_per_radius": [2, 4]}},
            "sampling.parameters.elements_per_radius",
            "has no effect beside discretisation.element_size",
        ),
    ],
)
def test_what_contradicts_it_is_told_at_its_key(problems, grid, changes, key, said):
    found = dict(problems(grid(SOLID | changes)))
    assert said in found[key]


def test_a_sample_may_have_solid(read, sample):
    changes = {
        "impact.beam_model": "solid",
        "discretisation": {"element_size": "1 mm"},
        "responses": ["peak_force"],
    }
    assert read(sample(changes)).impact.beam_model == "solid"


def test_corners_are_those_of_every_word(read, grid):
    """The middle one, too, of which neither the alphabet nor the list has it first or last."""
    laws = ["abbott_firestone", "jackson_green", "thornton"]
    varied = {"contact": laws, "velocity": [2, 1, 3]}
    bounds = read(grid({"sampling.parameters": varied})).sampling.bounds()
    assert bounds == {"contact": tuple(laws), "velocity": (1, 3)}


FURTHER = {"impact.strike_position": 0.25, "impact.further_spheres": "0.5 1 0"}


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"impact.strike_interval": "1 ms", "impact.strikes": 2}, "impact.strike_interval", "1 ms"),
        (
            {"sampling.parameters": {"strike_interval": ["20 ms", "1 ms"], "strikes": [1, 2]}},
            "sampling.parameters.strike_interval",
            "must be at least the duration",
        ),
        (
            FURTHER | {"discretisation.nodes": 41, "impact.further_spheres": "0.33 1 0"},
            "impact.further_spheres",
            "0.33 lies between",
        ),
        (FURTHER | {"discretisation": "auto"}, "discretisation.auto", "needs one sphere"),
        (
            FURTHER | {"impact.load": "contact_patch", "discretisation.scheme": "modal"},
            "impact.load",
            "must be point with further_spheres and scheme: modal",
        ),
        (
            FURTHER | {"sampling.parameters": {"further_spheres": ["0.5 1 0"]}},
            "sampling.parameters.further_spheres",
            "vary velocity and strike_position",
        ),
    ],
)
def test_strikes_and_spheres_at_odds_are_told_at_their_key(problems, grid, changes, key, said):
    assert said in dict(problems(grid(changes)))[key]


def test_a_place_varies_beside_a_further_sphere_in_the_middle(read, grid):
    """Without what is varied the first sphere would strike the middle, too."""
    places = {"sampling.parameters": {"strike_position": [0.25, 0.1]}, "discretisation.nodes": 41}
    cases = SOLVER.cases(design(read(grid(FURTHER | places))), np.arange(2))
    assert cases["strike_position"].tolist() == [0.25, 0.1]
