"""Impossible values are refused by name; implausible ones give a warning."""

import math
from pathlib import Path

import pytest

from impactlab.study.estimate import estimate


def implausible(study):
    return estimate(study, Path("no") / "results", 1).implausible


IMPOSSIBLE = [
    ("velocity", 1e9, "above the speed of a bar wave in the sphere (5164 m/s)"),
    ("velocity", 5300, "above the speed of a bar wave"),
    ("velocity", 1e-12, "is impossible"),
    ("beam_density", 1e-6, "faster than light"),
    ("sphere_density", 0.01, "solids have 10"),
    ("beam_yield_stress", "345 mPa", "mPa is not MPa"),
    ("sphere_yield_stress", "2550 mPa", "mPa is not MPa"),
    ("beam_width", 1e-10, "atoms are"),
    ("beam_depth", 20, "20 without a unit is read as 20 m: write '20 mm' if that is meant"),
    ("beam_yield_stress", 345, "345 without a unit is read as 345 Pa: write '345 MPa'"),
    ("sphere_mass", 1e-30, "a speck of dust"),
]
DOUBTED = [
    ("velocity", 100, "density velocity²/yield stress of the beam is 0.23"),
    ("beam_density", 78e6, "is implausible: solids have 10 (foam) to 22,600 (osmium)"),
    ("beam_yield_stress", "30 GPa", "a tenth of Young's modulus"),
    ("beam_depth", 0.2, "above a fifth of the span"),
    ("gravity", 9810, "274 is that of the sun"),
    ("sphere_radius", 0.5, "wider than the span"),
    ("sphere_radius", 33, "33 without a unit is read as 33 m: write '33 mm' if that is meant"),
    ("beam_density", 7.8, "write '7.8 g/cm3' if that is meant"),
]


@pytest.mark.parametrize(("name", "value", "words"), IMPOSSIBLE)
def test_the_impossible_is_refused_where_it_is_stated(refused, grid, name, value, words):
    text = grid({"sampling.parameters": {name: [value]}})
    refused(text, f"sampling.parameters.{name}", words)


@pytest.mark.parametrize(("name", "value", "words"), DOUBTED)
def test_an_implausible_value_gives_a_warning(read, grid, name, value, words):
    (warning,) = implausible(read(grid({"sampling.parameters": {name: [value]}})))
    assert warning.key == f"sampling.parameters.{name}"
    assert words in str(warning)


def test_the_key_is_that_of_the_section_where_it_is_not_varied(refused, grid):
    key = "impact.beam.material.yield_stress"
    refused(grid({key: "345 mPa"}), key)


def test_the_paper_s_case_is_beyond_doubt(read, grid, sample):
    assert implausible(read(grid())) == implausible(read(sample())) == ()
    # a beam too heavy to move is no obstacle to a wave
    heavy = {"beam_density": [7.8e9], "velocity": [20]}
    (warning,) = implausible(read(grid({"sampling.parameters": heavy})))
    assert warning.key == "sampling.parameters.beam_density"


def test_the_speed_of_a_bar_wave_is_that_of_the_softest_and_heaviest_beam(problems, read, grid):
    speed = math.sqrt(2.1e9 / 7800)
    soft = {"beam_youngs_modulus": ["2.1 GPa", "210 GPa"]}
    ((_, said),) = problems(grid({"sampling.parameters": soft | {"velocity": [1.001 * speed]}}))
    assert f"({speed:.4g} m/s)" in said
    read(grid({"sampling.parameters": soft | {"velocity": [0.999 * speed]}}))


@pytest.mark.parametrize(
    "given",
    [
        {"distribution": "uniform", "low": 1, "high": 6000},
        {"distribution": "lognormal", "median": 100, "geometric_standard_deviation": 5},
    ],
)
def test_the_ends_of_distributions_count(refused, sample, given):
    key = "sampling.parameters.velocity"
    refused(sample({key: given}), key, "above the speed of a bar wave")


def test_other_ends_and_places_are_refused_where_nothing_solves_them(refused, read, grid):
    coarse = {"discretisation.nodes": 41}
    key = "sampling.parameters.strike_position"
    places = {"sampling.parameters": {"strike_position": [0.25, 0.33]}}
    refused(grid(coarse | places), key, "0.33 lies between two of the 41 nodes: take 0.325 or 0.35")
    tip = {"sampling.parameters": {"strike_position": [0.0, 0.5]}}
    refused(grid(coarse | tip), key, "or the place of a free or elastic end")
    read(grid(coarse | tip | {"impact.beam": {"support_left": "free"}}))
    clamped = coarse | {"sampling.parameters": {"support_left": ["pinned", "clamped"]}}
    read(grid(clamped))
    for scheme in ("modal", "auto"):
        read(grid(clamped | {"discretisation.scheme": scheme}))
    models = {"support_left": ["clamped"], "beam_model": ["elastic", "rigid"]}
    key = "sampling.parameters.beam_model"
    refused(grid(coarse | {"sampling.parameters": models}), key, "with ends that are not pinned")


@pytest.mark.parametrize("model", ["timoshenko", "spring_mass", "rigid"])
def test_a_scheme_that_a_model_has_not_is_refused_before_the_run(refused, read, grid, model):
    modal, key = {"discretisation": {"scheme": "modal"}}, "discretisation.scheme"
    refused(grid(modal | {"impact.beam_model": model}), key, f"{model} has leapfrog alone")
    varied = {"sampling.parameters": {"beam_model": ["elastic", model], "velocity": [1]}}
    refused(grid(varied | modal), key)
    fixed = {"scheme": ["leapfrog"], "beam_model": [model]}
    read(grid({"sampling.parameters": fixed} | modal))


@pytest.mark.parametrize("model", ["spring_mass", "rigid"])
def test_a_lumped_beam_has_no_contact_patch(refused, grid, model):
    varied = {"sampling.parameters": {"beam_model": ["elastic", model]}}
    refused(grid(varied | {"impact.load": "contact_patch"}), "impact.load", model)


def test_the_three_dimensional_model_has_a_strain_rate(problems, grid):
    varied = {"beam_model": ["timoshenko", "solid"], "beam_rate_coefficient": [0, "40.4 s-1"]}
    given = {"sampling.parameters": varied, "discretisation": {"element_size": "1 mm"}}
    found = dict(problems(grid(given)))
    assert "sampling.parameters.beam_rate_coefficient" not in found


def test_a_study_has_one_law_of_the_strain_rate(problems, grid):
    both = {"beam_rate_coefficient": [0, "40.4 s-1"], "beam_rate_sensitivity": [0, 0.014]}
    found = " ".join(map(str, problems(grid({"sampling.parameters": both}))))
    assert "set one to 0" in found


def test_auto_stands_for_the_fastest_scheme_of_every_beam_model_of_the_study(read, grid):
    def scheme(*models):
        varied = {"sampling.parameters": {"beam_model": [*models], "velocity": [1]}}
        study = read(grid(varied | {"discretisation": {"scheme": "auto", "nodes": 21}}))
        return study.discretisation.scheme

    assert scheme("elastic", "euler_bernoulli") == "modal"
    assert scheme("elastic", "timoshenko") == "leapfrog"
