"""How far a planted plastic strain reaches along the surface."""

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.fem3d.solver import quarter_mesh
from impactlab.fem3d.solver.responses import surface_reach


@pytest.fixture(scope="module")
def planted():
    """A strain that falls along a line in x, on the top elements and twice as far below."""
    mesh = quarter_mesh(il.paper_impact(), element_size=2e-3)
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
    assert surface_reach(planted(20e-3), limit=0.002) == pytest.approx(16e-3)
    assert surface_reach(planted(20e-3), limit=0.005) == pytest.approx(10e-3)


def test_no_zone_and_a_whole_beam_of_it(planted):
    assert surface_reach(planted(20e-3, peak=0.001)) == 0.0
    everywhere = surface_reach(planted(1e3))
    assert everywhere == pytest.approx(0.39, abs=3e-3)
