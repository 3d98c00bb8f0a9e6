"""The plan and the cost of a 3-D run, before anything is solved."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from impactlab.fem3d import plan as plans
from impactlab.fem3d.plan import USUAL_TIME, beam_models, case_of, planned
from impactlab.fem3d.solver import estimate, impact_mesh, least_cost
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.study.schema.readers import read_impacts
from impactlab.validation.errors import StudyError

STUDIES = Path(__file__).parents[3] / "studies"

STUDY = """
title: Some
impact: {base: paper, velocity: 3 m/s}
discretisation: {nodes: 21, points: 3}
duration: 0.5 ms
sampling:
  method: sobol
  base_samples: 16
  parameters:
    beam_depth: {distribution: fixed, value: 30 mm}
    contact: {distribution: fixed, value: hertz}
    sphere_radius: {distribution: uniform, low: 30 mm, high: 40 mm}
    velocity: {distribution: uniform, low: 1 m/s, high: 2 m/s}
responses: [peak_force]
"""


@pytest.fixture
def quick():
    """The paper's case with few nodes for its beam models."""
    case = case_of(None)
    return replace(case, discretisation=replace(case.discretisation, nodes=41))


def test_a_study_gives_its_base_and_fixed_values_and_says_what_it_varies(tmp_path):
    path = tmp_path / "some.yaml"
    path.write_text(STUDY)
    case = case_of(read_impacts(path))
    assert (case.name, case.file, case.longest) == ("some", str(path), 0.5e-3)
    assert (case.impact.beam.depth, case.impact.contact, case.impact.velocity) == (0.03, "hertz", 3)
    assert case.held == {"sphere_radius": 0.035, "velocity": 3.0}
    other = case_of(read_impacts(path), velocity=5.0)
    assert other.impact.velocity == 5.0
    assert other.held == {"sphere_radius": 0.035}


@pytest.mark.parametrize("path", sorted(STUDIES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_study_of_impacts_has_a_witness(path):
    try:
        study = read_impacts(path)
    except StudyError:
        assert re.search("^(function|checks):", path.read_text(), re.MULTILINE)
        return
    case = case_of(study)
    assert case.held.keys() <= {*study.sampling.varied}


def test_a_varied_mass_is_held_at_that_of_the_spheres_density(tmp_path):
    varied = "sphere_mass: {distribution: uniform, low: 1, high: 2}"
    path = tmp_path / "some.yaml"
    path.write_text(re.sub("sphere_radius: .*", varied, STUDY))
    case = case_of(read_impacts(path))
    assert case.held["sphere_mass"] == pytest.approx(7800 * 4 / 3 * np.pi * 0.035**3)


def test_the_papers_case_takes_its_duration_and_about_a_minute(quick):
    found = planned(quick)
    assert found.duration == 0.45e-3  # as in the paper
    assert found.cost.cpu_seconds <= USUAL_TIME
    finer = impact_mesh(quick.impact, element_size=found.element_size / 2.5)
    assert estimate(finer, quick.impact, duration=found.duration).cpu_seconds > USUAL_TIME
    assert not found.problem(workers=1)
    # a smaller contact takes smaller elements
    small = replace(quick.impact, sphere=replace(quick.impact.sphere, radius=0.005))
    found = planned(replace(quick, impact=small), duration=5e-5)
    assert found.element_size < contact_radius(small) / 2
    # duration ends with the study at the latest
    assert planned(replace(quick, longest=0.3e-3), element_size=2e-3).duration == 0.3e-3
    unfinished = planned(replace(quick, longest=0.1e-3), element_size=2e-3)
    assert unfinished.duration == 0.1e-3
    assert np.isnan(unfinished.first_contact)
    # the floor of the cost lies below the cost
    for size in (2e-3, 1e-3):
        mesh = impact_mesh(quick.impact, element_size=size)
        cost = estimate(mesh, quick.impact, duration=1e-3)
        floor = least_cost(quick.impact, element_size=size, duration=1e-3)
        assert floor.elements < cost.elements
        assert floor.cpu_seconds < cost.cpu_seconds


def test_beside_the_middle_a_half_is_planned_for_models_that_bend(quick):
    beside = replace(quick, impact=replace(quick.impact, strike_position=0.375))
    plan, usual = (planned(case, element_size=2e-3) for case in (beside, quick))
    assert plan.cost.elements == pytest.approx(2 * usual.cost.elements, rel=0.1)
    floors = [least_cost(case.impact, element_size=2e-3, duration=1e-4) for case in (beside, quick)]
    assert floors[0].elements == pytest.approx(2 * floors[1].elements, abs=1)
    assert beam_models(quick.impact) == ("euler_bernoulli", "timoshenko", "spring_mass")
    assert beam_models(beside.impact) == ("euler_bernoulli", "timoshenko")


def test_a_moment_is_no_reason_for_a_mesh_without_bounds(quick):
    assert planned(quick, duration=1e-7).cost.elements < 500_000
    # a size beyond reason is refused
    with pytest.raises(ValueError, match=r"mesh.element_size = 1e-120 m: must be at least 3.5e-07"):
        planned(quick, element_size=1e-120)
    # a patch that does not fit is refused
    with pytest.raises(ValueError, match="to fit on beam and sphere"):
        planned(quick, patch=0.05)


def test_what_does_not_fit_memory_is_told_without_a_mesh(quick, monkeypatch):
    monkeypatch.setattr(plans, "impact_mesh", None)
    found = planned(quick, element_size=1e-6)
    problem = found.problem(workers=2)
    assert "--element-size 0.001 mm: about" in problem
    assert "of memory" in problem
    assert "--force" in problem


@pytest.mark.parametrize(
    ("given", "option"),
    [
        ({"duration": 3.0}, "--duration 3000 ms"),
        ({"element_size": 2.5e-4}, "--element-size 0.25 mm"),
    ],
)
def test_hours_are_told_at_what_drives_them(quick, given, option, monkeypatch):
    monkeypatch.setattr(plans, "MOST_TIME", 100.0)
    problem = planned(quick, **({"element_size": 2e-3} | given)).problem(workers=1)
    assert option in problem
    assert "steps of" in problem
    assert not planned(quick, element_size=2e-3).problem(workers=1)


@pytest.mark.parametrize("name", ["element_size", "patch", "duration"])
def test_numbers_that_make_no_sense_are_refused(quick, name):
    with pytest.raises(ValueError, match=rf"witness\.{name} = -1.0: must be above zero"):
        planned(quick, **{name: -1.0})


def test_threads_beyond_the_machines_make_nothing_faster(quick, monkeypatch):
    found = planned(quick, element_size=2e-3)
    monkeypatch.setattr(plans, "CPU_COUNT", 4)
    assert found.seconds(4) == found.seconds(1000) < found.seconds(1)
    assert found.seconds(1) > found.cost.cpu_seconds


def test_a_long_run_on_many_nodes_is_planned_at_once_and_its_beams_are_priced(quick):
    many = replace(quick, discretisation=replace(quick.discretisation, nodes=4001), longest=1.0)
    found = planned(many, element_size=2e-3)
    assert found.first_contact == pytest.approx(0.2e-3, rel=0.05)
    assert found.beam_seconds > 100.0 * planned(quick, element_size=2e-3).beam_seconds
