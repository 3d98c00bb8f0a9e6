import re

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis import ANALYSES
from impactlab.fem3d.wing import SIZES
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import PARAMETERS, SECTION
from impactlab.study.design import doubled
from impactlab.study.engine import Engine
from impactlab.study.estimate import estimate
from impactlab.study.execute import execute
from impactlab.study.inventory import Work
from impactlab.study.schema.readers import study_of_text
from impactlab.validation.errors import StudyError

GRID = """
title: A grid
description: Of two rules and three velocities.
impact: {base: paper, velocity: 7}
discretisation: {nodes: 51}
duration: 12 ms
sampling:
  method: grid
  parameters:
    rule: [lobatto, layers]
    velocity: [1, 0.5 m/s, 2]
responses: [peak_force]
store: {histories: true, samples: 7}
"""
BOX = {"gravity": (0.0, 10.0), "velocity": (1.0, 2.0), "beam_depth": (0.02, 0.03)}
SAMPLE = """
title: A sample
impact: {{base: paper}}
duration: 1 ms
sampling:
  method: sobol
  base_samples: {base_samples}
  second_order: {second_order}
  seed: {seed}
  parameters:
    gravity: {{distribution: uniform, low: 0, high: 10}}
    velocity: {{distribution: uniform, low: 1 m/s, high: 2 m/s}}
    beam_depth: {{distribution: uniform, low: 20 mm, high: 30 mm}}
analysis: {{confidence: 0.9, resamples: 50}}
"""


def test_a_grid_has_a_dimension_for_each_varied_parameter_and_scalars(designed):
    grid = designed(GRID)
    assert dict(grid.sizes) == {"rule": 2, "velocity": 3}
    assert grid["rule"].values.tolist() == ["lobatto", "layers"]
    assert grid["velocity"].values.tolist() == [1.0, 0.5, 2.0]
    assert grid["velocity"].attrs == {"units": "m s-1", "long_name": "impact velocity"}
    assert not grid.data_vars
    scalars = {name for name, coordinate in grid.coords.items() if coordinate.ndim == 0}
    absent = {"rule", "velocity", "sphere_mass", *SIZES, *SECTION} - {"beam_shape"}
    absent |= {"strike_interval", "further_spheres"}
    assert scalars == PARAMETERS.keys() - absent | {"duration"}
    assert grid["nodes"].item() == 51
    assert grid["duration"].item() == 0.012
    assert grid["beam_depth"].item() == paper_impact().beam.depth
    assert grid["duration"].attrs["units"] == "s"
    text = GRID.replace("velocity: 7", "sphere: {mass: 1.4}")
    assert designed(text)["sphere_mass"].item() == 1.4


def test_attributes_say_what_is_asked(designed):
    attrs = designed(GRID).attrs
    assert attrs.pop("study_text") == GRID
    assert len(attrs.pop("study_sha256")) == 64
    assert attrs == {
        "study": "some",
        "title": "A grid",
        "description": "Of two rules and three velocities.",
        "method": "grid",
        "varied": ["rule", "velocity"],
        "responses": ["peak_force"],
        "analyses": list(ANALYSES),
        "solver": "impact",
        "histories": 1,
        "profiles": 0,
        "history_samples": 7,
    }


def test_an_impossible_draw_is_named_before_anything_is_solved(designed, tmp_path):
    text = SAMPLE.format(base_samples=64, second_order=True, seed=1).replace(
        "uniform, low: 20 mm, high: 30 mm", "normal, mean: 20 mm, standard_deviation: 15 mm"
    )
    with pytest.raises(ValueError, match="must be above zero") as caught:
        execute(designed(text), tmp_path, Engine())
    assert re.search(r"run \d+ \(.*beam_depth = -0\.0.*\): Beam\.depth", str(caught.value))
    assert "truncated_normal" in str(caught.value)
    assert not list(tmp_path.glob("*/*.nc"))
    with pytest.raises(StudyError, match=r"some\.yaml: sampling\.parameters: .*beam_depth = -0\.0"):
        estimate(study_of_text("some", text), tmp_path, workers=1)


def test_an_impossible_combination_is_named_and_a_possible_one_is_not(designed):
    """The ranges drawn overlap in both samples; only a run with depth >= span is wrong."""
    text = SAMPLE.format(base_samples=8, second_order=True, seed=1).replace(
        "velocity: {distribution: uniform, low: 1 m/s, high: 2 m/s}",
        "beam_span: {distribution: normal, mean: 40 mm, standard_deviation: SPREAD mm}",
    )
    with pytest.raises(ValueError, match="must be below the span") as caught:
        Work.of(designed(text.replace("SPREAD", "12")))
    assert "beam_span = " in str(caught.value)
    possible = designed(text.replace("SPREAD", "8"))
    assert Work.of(possible).keys.size == possible.sizes["run"]
    assert possible["beam_span"].min() < possible["beam_depth"].max()


@pytest.mark.parametrize("text", [GRID, SAMPLE.format(base_samples=4, second_order=False, seed=0)])
def test_a_design_survives_netcdf(designed, tmp_path, text):
    made = designed(text)
    made.to_netcdf(tmp_path / "design.nc")
    with xr.open_dataset(tmp_path / "design.nc") as kept:
        xr.testing.assert_equal(kept, made)
        for key, value in made.attrs.items():
            assert np.array_equal(np.atleast_1d(kept.attrs[key]), np.atleast_1d(value))
        for name in made.coords:
            assert kept[name].attrs == made[name].attrs


@pytest.mark.parametrize(("second_order", "seed"), [(True, 0), (False, 1)])
def test_runs_are_found_again_in_twice_as_many(sampled, second_order, seed, tmp_path):
    """By their keys, under which shards keep the answers: no run is solved twice."""
    normal = {"distribution": "normal", "mean": 0.06, "standard_deviation": 0.001}
    small = sampled(
        "sobol",
        {"beam_width": normal},
        base_samples=16,
        second_order=second_order,
        seed=seed,
        groups={"section": ["beam_depth", "beam_width"]},
    )
    small.to_netcdf(tmp_path / "design.nc")
    large = doubled(xr.load_dataset(tmp_path / "design.nc"))
    keys, more = (Work.of(each).keys for each in (small, large))
    assert more.size == 2 * keys.size
    assert np.array_equal(more[: keys.size], keys)
    assert doubled(large).attrs["base_samples"] == 64
    changed = {key for key in large.attrs if large.attrs[key] != small.attrs[key]}
    assert changed == {"base_samples"}


def test_a_design_drawn_in_another_way_is_refused(sampled):
    small = sampled("sobol", base_samples=16)
    other = small.assign_coords(gravity=small["gravity"] + 1e-12)
    with pytest.raises(
        ValueError, match=r"'some' was drawn by another version .*\(gravity differs"
    ):
        doubled(other)
    # only sobols sample can be doubled
    with pytest.raises(ValueError, match="only a sample with method: sobol can be extended"):
        doubled(sampled("delta", samples=64))


def test_parameters_of_a_test_function_carry_their_meaning(designed):
    """The drawn ones and the one that keeps the middle of its range."""
    found = designed("""
title: A function
function: ishigami
sampling:
  method: pawn
  samples: 100
  parameters:
    x1: {distribution: uniform, low: -1, high: 1}
    x3: {distribution: uniform, low: -1, high: 1}
""")
    for name in ("x1", "x2", "x3"):
        assert found[name].attrs["long_name"] == name  # the label of figures and sentences
        assert found[name].attrs["units"] == "1"
    assert found["x3"].attrs["distribution"] == "uniform"
