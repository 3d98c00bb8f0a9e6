"""Study files of every kind."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from impactlab.fem3d.wing import SIZES
from impactlab.methods.grid import Grid
from impactlab.methods.sobol import Sobol
from impactlab.model.bodies import Beam, Sphere
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.material import Material
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.study.schema.declarations import Analysis, ImpactStudy, Store, Verification
from impactlab.study.schema.readers import read_any, read_impacts, read_study, read_verification
from impactlab.validation.errors import StudyError
from impactlab.variables import RESPONSES
from impactlab.verification.catalogue import CATALOGUE

STUDIES = sorted((Path(__file__).parents[4] / "studies").glob("*.yaml"))

SPELLED_OUT = """
title: Spelled out
impact:
  velocity: 2 m/s
  contact: hertz
  sphere:
    radius: 10 mm
    material: {density: 2500, youngs_modulus: 70 GPa, poissons_ratio: 20 %, yield_stress: 1 GPa}
  beam:
    span: 200 mm
    width: 1 cm
    depth: 5 mm
    material:
      density: 2.7 g/cm3
      youngs_modulus: 70 GPa
      poissons_ratio: 0.33
      yield_stress: 250 MPa
      kinematic_hardening_modulus: 1 GPa
discretisation: {nodes: 51, points: 4, rule: legendre, courant: 0.5}
duration: 0.001
sampling: {method: grid, parameters: {contact: [hertz]}}
responses: [restitution, peak_force]
store: {histories: true, profiles: true, samples: 11}
"""


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_committed_studies_are_sound(path, validator):
    study = read_any(path)
    content = YAML(typ="safe").load(study.text)
    assert [error.message for error in validator.iter_errors(content)] == []
    assert study.name == path.stem
    assert study.text == path.read_text(encoding="utf-8")


def test_tolerances_are_compared_at_fixed_velocities():
    """The same draws at each; the velocity, which would take most of the variance, stands apart."""
    names = ("sobol_slow", "sobol", "sobol_fast", "sobol_large")
    *three, large = (read_study(STUDIES[0].with_name(f"{name}.yaml")) for name in names)
    assert [study.impact.velocity for study in three] == [1.0, 5.0, 15.0]
    first, *others = (study.sampling.columns() for study in three)
    for other in others:
        np.testing.assert_equal(other, first)
    assert set(large.sampling.varied) - set(three[0].sampling.varied) == {"velocity"}
    # about 50 processor-seconds with pilot runs and refinement
    assert sum(study.sampling.runs * study.duration for study in three) < 100


def test_a_short_file_takes_the_rest_from_base_and_defaults(read, grid):
    study = read(grid())
    assert study.impact == paper_impact()
    assert study.discretisation == Discretisation()
    assert study.duration == 0.012
    assert isinstance(study.sampling, Grid)
    assert study.sampling.parameters == {"velocity": (0.5, 1.0)}
    assert study.responses == tuple(RESPONSES)  # those of several strikes are listed by name
    assert study.store == Store(histories=False, profiles=False, samples=1000)
    assert study.analysis == Analysis(confidence=0.95, resamples=200)
    assert (study.name, study.title, study.description) == ("some-study_1", "A grid", "")
    assert study.sha256 == hashlib.sha256(grid().encode()).hexdigest()


def test_everything_can_be_spelled_out(read):
    study = read(SPELLED_OUT)
    glass = Material(density=2500, youngs_modulus=70e9, poissons_ratio=0.2, yield_stress=1e9)
    aluminium = Material(
        density=2700,
        youngs_modulus=70e9,
        poissons_ratio=0.33,
        yield_stress=250e6,
        kinematic_hardening_modulus=1e9,
    )
    assert study.impact == Impact(
        sphere=Sphere(radius=0.01, material=glass),
        beam=Beam(span=0.2, width=0.01, depth=0.005, material=aluminium),
        velocity=2.0,
        contact="hertz",
    )
    assert study.discretisation == Discretisation(nodes=51, points=4, rule="legendre", courant=0.5)
    assert study.responses == ("restitution", "peak_force")
    assert study.store == Store(histories=True, profiles=True, samples=11)


def test_a_base_is_changed_in_parts(read, grid):
    study = read(grid({"impact.beam.material.yield_stress": "420 MPa"}))
    assert study.impact.beam.material.yield_stress == 420e6
    assert study.impact.beam.material.youngs_modulus == paper_impact().beam.material.youngs_modulus
    assert study.impact.sphere == paper_impact().sphere


def test_a_grid_keeps_its_parameters_and_values_in_the_order_of_the_file(read, grid, sample):
    wanted = {"rule": ["legendre", "lobatto"], "nodes": [21, 11], "gravity": [0, 9.81]}
    study = read(grid({"sampling.parameters": wanted}))
    assert list(study.sampling.parameters.items()) == [
        ("rule", ("legendre", "lobatto")),
        ("nodes", (21, 11)),
        ("gravity", (0.0, 9.81)),
    ]
    assert study.sampling.runs == 8
    # a sample keeps its parameters in the order of the file
    uniform = {"distribution": "uniform", "low": 1, "high": 2}
    wanted = dict.fromkeys(["sphere_mass", "gravity", "velocity"], uniform)
    study = read(sample({"sampling.parameters": wanted}))
    assert isinstance(study.sampling, Sobol)
    assert list(study.sampling.parameters) == list(wanted)
    assert study.sampling.runs == 8 * (2 * 3 + 2)
    assert study.sampling.seed == 1


@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("gravity", {"start": 0, "stop": 1, "number": 11}, tuple(n / 10 for n in range(11))),
        (
            "beam_depth",
            {"start": "20 mm", "stop": "40 mm", "number": 3, "spacing": "linear"},
            (0.02, 0.03, 0.04),
        ),
        (
            "velocity",
            {"start": "0.1 m/s", "stop": 10, "number": 3, "spacing": "log"},
            (0.1, 1.0, 10.0),
        ),
        ("nodes", {"start": 11, "stop": 31, "number": 3}, (11, 21, 31)),
    ],
)
def test_ranges(read, grid, name, given, values):
    result = read(grid({"sampling.parameters": {name: given}})).sampling.parameters[name]
    assert result == values
    assert {type(value) for value in result} == {type(values[0])}


def test_every_parameter_can_be_varied(read, grid):
    values = flatten(paper_impact(), Discretisation()) | {"sphere_mass": 1.4}
    values |= {"shear_coefficient": 0.8, "beam_shape": "tube", "beam_wall_thickness": 0.003}
    values |= {"beam_flange_thickness": 0.003, "beam_web_thickness": 0.003, "strike_interval": 1}
    assert values.keys() == PARAMETERS.keys() - {
        *SIZES,
        "beam_profile",
        "beam_layers",
        "further_spheres",
    }  # see test_solid
    square = {"shape": "box", "width": 0.0278, "wall_thickness": "4 mm"}
    i = {"shape": "i", "flange_thickness": "4 mm", "web_thickness": "4 mm"}
    beams = {"beam_shape": square, "beam_wall_thickness": square}
    beams |= {"beam_flange_thickness": i, "beam_web_thickness": i}
    for name, value in values.items():
        impact = {"strikes": 2} if name == "strike_interval" else {}
        impact |= {"beam": beams.get(name, {})}
        changes = {f"impact.{key}": entry for key, entry in impact.items()}
        study = read(grid({"sampling.parameters": {name: [value]}} | changes))
        assert study.sampling.parameters == {name: (value,)}


TEXT = "title: Checks\nchecks: [half_space]\n"


@pytest.fixture
def file(tmp_path):
    """Writes a study file."""

    def write(text, name="some.yaml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def said(read, path):
    with pytest.raises(StudyError) as caught:
        read(path)
    return str(caught.value)


def test_a_list_of_checks(file, grid):
    path = file(TEXT)
    study = read_verification(path)
    assert (study.name, study.path, study.text) == ("some", path, TEXT)
    assert (study.title, study.description) == ("Checks", "")
    assert study.checks == ("half_space",)
    assert study.size == "1 check"
    assert study.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()
    assert isinstance(read_any(path), Verification)
    assert isinstance(read_any(file(grid())), ImpactStudy)
    assert read_verification(file("title: x\nchecks: all\n")).checks == tuple(CATALOGUE)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("title: x\nchecks: [half_spce]\n", "checks.0 = 'half_spce': unknown check; did you mean"),
        ("title: x\nchecks: [half_space, half_space]\n", "names half_space more than once"),
        ("title: x\nchecks: []\n", "checks = []: expected `all`, or a list of names"),
        ("title: x\nchecks: some\n", "checks = 'some': expected `all`, or a list of names"),
        ("title: x\nchecks:\n", "checks = null: expected `all`, or a list of names"),
        ("title: x\nchecks: all\nduration: 1 ms\n", "duration = '1 ms': unknown key"),
        ("titel: x\nchecks: all\n", "titel = 'x': unknown key; did you mean 'title'?"),
        ("checks: all\n", "title: is required"),
        ("title: x\ncheck: all\n", "check = 'all': unknown key; did you mean 'checks'?"),
        ("title: x\nchecks: all\nchecks: all\n", 'duplicate key "checks"'),
    ],
)
def test_mistakes_name_file_and_key(file, text, words):
    path = file(text)
    for read in (read_any, read_verification):
        lines = said(read, path)
        assert words in lines
        assert all(line.startswith(f"{path}: ") for line in lines.splitlines())


def test_the_other_kind_is_sent_to_its_command(file, grid):
    checks, runs = file(TEXT, "checks.yaml"), file(grid(), "runs.yaml")
    assert f"use `impactlab verify {checks}`" in said(read_study, checks)
    assert f"use `impactlab run {runs}`" in said(read_verification, runs)
    function = STUDIES[0].with_name("ishigami.yaml")
    assert "has no discretisation: use a study of impacts" in said(read_impacts, function)
    # all mistakes are told at once
    told = said(read_any, file("titel: x\nchecks: [half_spce]\n"))
    assert len(told.splitlines()) == 3
