"""Contacts and peaks between steps, and the reach of a planted plastic strain along the surface."""

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.fem3d.solver import impact_mesh
from impactlab.fem3d.solver.evaluation import contacts, first_duration, peak, plastic_reach


def test_start_and_end_between_steps_and_short_pauses_do_not_count():
    time = np.arange(0.0, 10.0, 0.1)
    force = np.maximum(3.03 - time, 0.0) + np.where(time > 6.0, np.maximum(8.07 - time, 0.0), 0.0)
    force[12] = 0.0
    found = contacts(time, force, 0.5)
    np.testing.assert_allclose(found, [[0.0, 3.03], [6.1, 8.07]], atol=1e-9)


def test_a_pause_below_a_twentieth_does_not_end_the_first_contact():
    assert first_duration(np.array([[0.0, 1.0], [1.04, 2.0], [2.3, 3.0]])) == 2.0
    assert first_duration(np.array([[0.0, 1.0], [1.2, 2.0]])) == 1.0
    assert np.isnan(first_duration(np.array([[0.0, 1.0], [1.04, np.nan]])))


def test_a_contact_at_the_end_has_no_end():
    time = np.arange(0.0, 1.0, 0.1)
    assert np.isnan(contacts(time, np.ones(10), 0.25)[0, 1])
    force = np.where(time < 0.85, 1.0, 0.0)
    assert np.isnan(contacts(time, force, 0.25)[0, 1])
    # no contact
    assert contacts(np.arange(3.0), np.zeros(3), 1.0).shape == (0, 2)
    # a parabolas peak is exact between steps
    time = np.linspace(0.0, 1.0, 12)
    at, largest = peak(time, 5.0 - 3.0 * (time - 0.337) ** 2)
    assert at == pytest.approx(0.337, rel=1e-12)
    assert largest == pytest.approx(5.0, rel=1e-12)
    assert peak(time, time) == (1.0, 1.0)


@pytest.fixture(scope="module")
def planted():
    """A strain that falls along a line in x, on the top elements and twice as far below."""
    mesh = impact_mesh(il.paper_impact(), element_size=2e-3)
    centres = mesh.nodes[mesh.elements].mean(axis=1)

    def build(reach, peak=0.01):
        below = centres[:, 2] < -2e-3
        strain = peak * np.maximum(1.0 - centres[:, 0] / np.where(below, 2.0 * reach, reach), 0.0)
        return xr.Dataset(
            {"equivalent_plastic_strain": ("element", strain)},
            coords={
                "node_position": (("node", "axis"), mesh.nodes),
                "element_nodes": (("element", "corner"), mesh.elements),
                "body": ("element", mesh.body),
                "element_size": mesh.element_size,
            },
        )

    return build


def test_the_line_is_followed_down_to_the_limit(planted):
    assert plastic_reach(planted(20e-3), 0, limit=0.002) == pytest.approx(16e-3)
    assert plastic_reach(planted(20e-3), 0, limit=0.005) == pytest.approx(10e-3)
    # Elements of 2 mm: a strain that falls by 0.1 % per mm, from 1 % at the surface.
    run = planted(1e3)
    depth = -run["node_position"].values[run["element_nodes"].values][:, :, 2].mean(axis=1)
    strain = 0.01 - depth
    found = plastic_reach(run.assign(equivalent_plastic_strain=("element", strain)), 2, limit=0.004)
    assert found == pytest.approx(6e-3)
    assert plastic_reach(planted(1e3, peak=0.001), 2) == 0.0
    # no zone and a whole beam of it
    assert plastic_reach(planted(20e-3, peak=0.001), 0) == 0.0
    everywhere = plastic_reach(planted(1e3), 0)
    assert everywhere == pytest.approx(0.39, abs=3e-3)
