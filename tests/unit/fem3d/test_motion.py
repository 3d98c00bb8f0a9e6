"""The section through the contact of a 3-D run, at times within it."""

import numba
import numpy as np
import pytest

import impactlab as il
from impactlab.fem3d.figures.run import animation, faces
from impactlab.fem3d.solver import impact_mesh, solve_on
from impactlab.fem3d.solver.dataset import FRAMES

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="thousands of elements")

IMPACT = il.paper_impact(15.0)


@pytest.fixture(scope="module")
def runs():
    mesh = impact_mesh(IMPACT, element_size=4e-3)
    options = {"duration": 6e-5, "samples": 101}
    return [solve_on(mesh, IMPACT, frames=frames, **options) for frames in (False, True)]


def test_answers_are_the_same_with_and_without_frames(runs):
    plain, kept = runs
    assert {*kept.variables} - {*plain.variables} == {*FRAMES}
    for name, array in plain.variables.items():
        np.testing.assert_array_equal(kept[name], array, err_msg=str(name))
    for name, (units, _) in FRAMES.items():
        assert kept[name].attrs["units"] == units


def test_frames_end_with_the_fields_of_the_end(runs):
    _, run = runs
    polygons, elements = faces(run, 1)
    place = run["section_position"].values
    np.testing.assert_allclose(1e3 * place[0], polygons, atol=1e-12)
    moved = run.assign(node_position=run["node_position"] + run["displacement"])
    np.testing.assert_allclose(1e3 * place[-1], faces(moved, 1)[0], atol=1e-12)
    strain = run["section_plastic_strain"].values
    np.testing.assert_array_equal(strain[-1], run["equivalent_plastic_strain"].values[elements])
    assert not strain[0].any()
    assert strain[-1].max() > 0.01


def test_plastic_strain_never_shrinks_and_times_rise(runs):
    _, run = runs
    assert (run["section_plastic_strain"].diff("field_time") >= 0.0).all()
    assert (np.diff(run["field_time"]) > 0.0).all()
    assert run.sizes["field_time"] > 10


def test_the_picture_moves_with_the_section(runs):
    _, run = runs
    moving = animation(run)
    section = moving._figure.axes[0]
    (cells,) = section.collections
    moving._update(moving.frames - 1)
    shown = np.array([path.vertices[:4] for path in cells.get_paths()])
    corners = 1e3 * run["section_position"].values[-1]
    near = [face for face in shown if (face[:, 0] >= 0.0).all()]
    assert len(near) == len(shown) // 2  # the other half is mirrored
    known = {tuple(face.round(9).ravel()) for face in corners}
    assert all(tuple(face.round(9).ravel()) in known for face in np.array(near))
    assert cells.get_array().max() == 100 * run["section_plastic_strain"].values[-1].max()
    frames = list(moving._drawn())[1:]
    assert (frames[0] != frames[-1]).any()
