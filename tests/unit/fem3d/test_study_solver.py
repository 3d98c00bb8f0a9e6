"""Runs of the 3-D FE model in a study: the same as alone, and a failed one is data."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import impactlab as il
from impactlab.fem3d import solver as solid
from impactlab.fem3d import study_solver as witness
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.fem3d.wing import VARIABLES
from impactlab.model.cost import A_SECOND
from impactlab.model.parameters import with_values
from impactlab.study.design import design
from impactlab.study.engine import Engine
from impactlab.study.estimate import estimate
from impactlab.study.execute import execute
from impactlab.study.inventory import Work
from impactlab.study.schema.readers import study_of_text
from impactlab.study.store import OutputSpec
from impactlab.variables import STATUS_FLAGS

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

TEXT = """
title: Both
impact: {base: paper}
duration: 0.02 ms
sampling:
  method: grid
  parameters:
    nodes: [51, 101]
    beam_model: [timoshenko, solid]
    element_size: [4 mm, 3 mm]
responses: [peak_force, number_of_contacts, energy_error]
store: {histories: true, samples: 5}
"""
ALL = np.arange(8)
HERE = OutputSpec(5, profiles=False)


@pytest.fixture(scope="module")
def study():
    return study_of_text("both", TEXT)


@pytest.fixture(scope="module")
def solved(study, tmp_path_factory):
    return execute(design(study), tmp_path_factory.mktemp("shards"), Engine(workers=2))


def test_each_model_answers_as_it_does_alone(solved):
    beam = replace(il.paper_impact(), beam_model="timoshenko")
    alone = il.simulate(beam, il.Discretisation(nodes=101), duration=2e-5, samples=5)
    there = solved.sel(beam_model="timoshenko", nodes=101, element_size=3e-3)
    assert there["energy_error"] == alone["energy_error"]
    np.testing.assert_array_equal(there["contact_force"], alone["contact_force"])
    alone = solid.solve(il.paper_impact(), element_size=3e-3, duration=2e-5)
    there = solved.sel(beam_model="solid", nodes=101, element_size=3e-3)
    assert there["energy_error"] == alone["energy_error"]
    assert there["status"] == alone["status"].item() & there["status"]
    force = np.interp(there["time"], alone["time"], alone["contact_force"])
    np.testing.assert_allclose(there["contact_force"], force, rtol=2e-3)
    assert there["contact_force"][-1] > 100.0
    assert there["midspan_curvature"].isnull().all()
    for name in VARIABLES:
        assert solved[name].sel(beam_model="timoshenko").isnull().all()
        assert (solved[name].sel(beam_model="solid") >= 0).all()
    assert 0.0 < solved["processor_time"].max() < 100.0


SPRINGS = {"support_left": "elastic", "stiffness_left": 1e8, "rotational_stiffness_left": 1e4}


@pytest.mark.parametrize(
    ("beam", "name", "values"),
    [
        ({"support_left": "clamped"}, "strike_position", (0.1, 0.5)),
        (SPRINGS, "foundation_stiffness", (0.0, 1e9)),
        ({"stiffness_damping": 1e-7}, "mass_damping", (0.0, 2e3)),
    ],
    ids=["ends and places", "springs and foundation", "damping"],
)
def test_ends_springs_and_damping_reach_the_3d_model(beam, name, values):
    keys = ", ".join(f"{key}: {value}" for key, value in beam.items())
    text = TEXT.replace("base: paper", f"base: paper, beam: {{{keys}}}")
    text = text.split("sampling:")[0] + (
        "discretisation: {element_size: 4 mm}\n"
        "sampling:\n  method: grid\n"
        f"  parameters: {{beam_model: [timoshenko, solid], {name}: {[*values]}}}\n"
        "responses: [peak_force, energy_error]\n"
    )
    cases = witness.cases(design(study_of_text("beams", text)), ALL[:4])
    answers = witness.solve(cases[2:], HERE)
    deflections = answers["midspan_deflection"][:, -1]
    for row, value in enumerate(values):
        parameters = beam | {name: value}
        impact, _ = with_values(il.paper_impact(), il.Discretisation(), parameters)
        alone = solid.solve(impact, element_size=4e-3, duration=2e-5)
        assert answers["energy_error"][row] == alone["energy_error"]
        assert deflections[row] == pytest.approx(alone["midspan_deflection"][-1].item(), rel=1e-12)
    assert deflections[0] != pytest.approx(deflections[1], rel=1e-6)


def test_damping_of_modes_is_refused_in_a_study():
    wrong = TEXT.replace("nodes: [51, 101]", "damping_ratio: [0, 0.01]")
    with pytest.raises(il.StudyError, match=r"with damping_ratio: change it, or set that"):
        study_of_text("damped", wrong)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"strikes": 3}, r"Impact\.strikes = 3: .* struck once by one sphere: set it to 1"),
        ({"further_spheres": "0.25 1.0 0.0"}, "struck once by one sphere: leave it out"),
        ({"damping_ratio": 0.01}, r"Beam\.damping_ratio = 0\.01: is of modes, .*: set it to 0, "),
    ],
)
def test_what_the_3d_model_leaves_out_is_refused(values, words):
    """Impacts of other models of the beam, which `impactlab witness` is given, are refused, too."""
    impact = il.paper_impact()
    if "damping" in next(iter(values)):
        values = {"beam": replace(impact.beam, **values)}
    with pytest.raises(ValueError, match=words):
        solid.solve(replace(impact, **values), element_size=4e-3, duration=2e-6)


def test_what_a_model_does_not_know_is_nothing_to_it(study, solved):
    """Four of eight runs differ: two of the beam, two of the 3-D FE model."""
    work = Work.of(design(study))
    assert np.unique(work.keys).size == 4
    assert np.count_nonzero(work.cost) == 4
    assert (solved["energy_error"].sel(beam_model="solid").std("nodes") == 0).all()
    assert (solved["energy_error"].sel(beam_model="timoshenko").std("element_size") == 0).all()
    assert (solved["energy_error"].std(["nodes", "element_size"]) > 0).all()


def test_elements_follow_the_contact_radius():
    """The radius of a plastic contact grows with the root of the velocity."""
    told = TEXT.replace("nodes: [51, 101]", "velocity: [1, 4]")
    told = told.replace("element_size: [4 mm, 3 mm]", "elements_per_radius: [1, 2]")
    cases = witness.cases(design(study_of_text("both", told)), ALL)
    sizes = cases["element_size"].reshape(2, 2, 2)  # velocity, model, elements
    assert (sizes[:, 0] == 0.0).all()
    first = contact_radius(il.paper_impact(velocity=1.0))
    expected = first * np.array([[1.0, 0.5], [2.0, 1.0]])
    np.testing.assert_allclose(sizes[:, 1], expected, rtol=1e-12)


def test_the_same_bits_in_any_batch(study):
    cases = witness.cases(design(study), ALL)
    together = witness.solve(cases, HERE)
    for at in (0, 3, 5):
        found = witness.solve(cases[at : at + 1], HERE)
        del found["processor_time"]
        for name, values in found.items():
            np.testing.assert_array_equal(values[0], together[name][at])


def test_the_cost_counts_what_is_solved_once(study):
    found = estimate(study, Path("no"), workers=2)
    impact = il.paper_impact()
    seconds = [
        solid.estimate(solid.impact_mesh(impact, element_size=h), impact, duration=2e-5)
        for h in (3e-3, 4e-3)
    ]
    assert found.seconds == pytest.approx(sum(each.cpu_seconds for each in seconds), rel=0.2)
    assert found.largest_run["beam_model"] == "solid"
    cases = witness.cases(design(study), ALL)
    assert witness.work(cases).sum() / A_SECOND == pytest.approx(found.seconds)


def only_solid(study):
    return witness.cases(design(study), ALL[3:4])


@pytest.mark.parametrize("words", ["an element was squeezed flat", "diverged before 1e-5 s"])
def test_a_run_that_stops_is_an_answer_without_numbers(study, monkeypatch, caplog, words):
    def stopped(*args, **kwargs):
        return solid.solve(*args, **kwargs).assign_attrs(stopped=words)

    monkeypatch.setattr(witness, "solve_alone", stopped)
    found = witness.solve(only_solid(study), HERE)
    assert found["status"][0] & STATUS_FLAGS["stopped"][0]
    assert np.isnan(found["peak_force"]).all()
    assert np.isnan(found["contact_force"]).all()
    assert words in caplog.text


def test_a_run_that_was_interrupted_is_no_answer(study, monkeypatch):
    def interrupted(*args, **kwargs):
        return solid.solve(*args, **kwargs).assign_attrs(stopped="interrupted at 1e-05 s")

    monkeypatch.setattr(witness, "solve_alone", interrupted)
    with pytest.raises(KeyboardInterrupt):
        witness.solve(only_solid(study), HERE)


def test_a_patch_that_is_outgrown_is_enlarged_while_there_is_room(study, monkeypatch):
    patches = []

    def small(impact, *, patch, **others):
        patches.append(patch)
        run = solid.solve(impact, patch=patch, **others)
        outgrown = {"stopped": "the contact has grown", "patch_needed": least}
        return run.assign_attrs(outgrown) if patch < least else run

    monkeypatch.setattr(witness, "solve_alone", small)
    usual, least = 0.009, 0.013
    found = witness.solve(only_solid(study), HERE)
    assert patches == pytest.approx([usual, 1.5 * usual])
    assert np.isfinite(found["energy_error"]).all()
    least = 1.0
    found = witness.solve(only_solid(study), HERE)
    assert found["status"][0] == STATUS_FLAGS["stopped"][0]


def test_the_answers_depend_on_the_sources_of_both():
    from impactlab.fem3d.solver.compiler import COMPILER
    from impactlab.solver.jit import SOURCES_HASH

    assert len({witness.SOLVER.version, SOURCES_HASH, COMPILER.sources_hash}) == 3


def test_what_does_not_fit_memory_is_priced_without_a_mesh(monkeypatch):
    def watched(impact, *, element_size):
        assert element_size > 1e-4
        return solid.impact_mesh(impact, element_size=element_size)

    monkeypatch.setattr(witness, "impact_mesh", watched)
    fine = TEXT.replace("[4 mm, 3 mm]", "[0.01 mm]")
    found = estimate(study_of_text("fine", fine), Path("no"), workers=1)
    assert found.memory > 1e10
    assert found.seconds > 86400.0
