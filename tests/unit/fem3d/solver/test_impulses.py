"""Impulses integrated over faces: overlaps closed, momentum kept, work counted."""

import numpy as np
import pytest

from impactlab.fem3d.solver.impulses import PARTS, RULE, SHAPE, bulges, close_gaps
from impactlab.fem3d.solver.mesh import faces_of

DT, SIDE = 0.1, 3
"""Seconds of a step; pairs along a side of the patch, whose faces are squares of 1 m."""
X, Y = (place.ravel() for place in np.meshgrid(range(SIDE), range(SIDE), indexing="ij"))


class Patch:
    """Four faces of nine pairs of 2 and 3 kg, apart by `gap` (9,) in m after a predicted step."""

    def __init__(self, gap, bulge=0.0, rim=False, slope=0.0):
        count = SIDE**2
        self.pairs = np.arange(2 * count, dtype=np.int32).reshape(2, count).T.copy()
        self.mass = np.repeat([2.0, 3.0], count)
        self.x, self.v = np.zeros((2 * count, 3)), np.zeros((2 * count, 3))
        self.x[:count, 2] = gap
        self.v[:count, 2] = -1.0
        self.faces, self.approach = faces_of(SIDE, SIDE), np.ones(count)
        self.bulge, self.closing = np.full((4, len(SHAPE)), bulge), np.zeros(count)
        self.rim, self.normals = np.full(count, rim), np.tile([-slope, 0.0, 1.0], (count, 1))

    def close(self):
        share = 1.0 / np.bincount(self.faces.ravel())
        inverse = np.repeat(1.0 / self.mass[:, None], 3, axis=1)
        surfaces = (self.faces, self.bulge, share, self.pairs, self.rim, self.normals)
        return close_gaps(RULE, *surfaces, inverse, self.x, self.v, DT, self.approach, self.closing)

    @property
    def gap(self):
        return self.x[self.pairs[:, 0], 2] - self.x[self.pairs[:, 1], 2]

    @property
    def kinetic(self):
        return 0.5 * np.sum(self.mass[:, None] * self.v**2)


def test_an_even_overlap_is_closed_to_zero_and_momentum_stays():
    patch = Patch(-0.02)
    before = patch.v.copy()
    impulse, *_, beyond = patch.close()
    np.testing.assert_allclose(patch.gap, 0.0, atol=1e-15)
    upper, lower = (patch.mass * (patch.v - before)[:, 2]).reshape(2, -1).sum(axis=1)
    assert impulse == pytest.approx(upper, rel=1e-14)
    assert lower == pytest.approx(-upper, rel=1e-14)
    assert impulse == pytest.approx(9 * 0.02 / DT * 2 * 3 / 5, rel=1e-12)
    assert not beyond


def test_nodes_that_slid_touch_the_sphere_beside_its_nodes_without_friction():
    slope, slid = 0.2, 0.05
    patch = Patch(-0.02, slope=slope)
    patch.x[9:, 0] += slid
    before = patch.v.copy()
    patch.close()
    relative = np.diff(patch.x.reshape(2, 9, 3), axis=0)[0]
    np.testing.assert_allclose(relative[:, 2], slope * relative[:, 0], atol=1e-15)
    pushes = patch.mass[:, None] * (patch.v - before)
    np.testing.assert_allclose(pushes[:9], -pushes[9:], rtol=1e-12)
    np.testing.assert_allclose(pushes @ [1.0, 0.0, slope], 0.0, atol=1e-15)
    expected = (0.02 - slope * slid) / (DT * (1 / 2 + 1 / 3) * (1 + slope**2))
    np.testing.assert_allclose(pushes[:9, 2], expected, rtol=1e-12)


def test_a_gap_is_left_alone():
    patch = Patch(0.01)
    before = patch.x.copy()
    assert patch.close()[:3] == (0.0, 0.0, 0.0)
    assert np.array_equal(patch.x, before)
    assert not patch.closing.any()
    # a bulge touches before the nodes
    patch = Patch(0.001, bulge=0.003)
    patch.close()
    np.testing.assert_allclose(patch.gap, 0.003, rtol=1e-12)


@pytest.mark.parametrize("edge", [0.3, 0.7, 1.0, 1.45, 1.9])
def test_the_force_grows_with_the_part_of_a_face_that_touches(edge):
    """Overlap rises from the line x = edge towards x = 0: its integral is that of a triangle.

    Nodes on the patch's border stand for half a face: as heavy as others, they count double.
    """
    patch = Patch(0.01 * (X - edge))
    patch.close()
    area = np.where(X == 1, 1.0, 0.5) * np.where(Y == 1, 1.0, 0.5)
    assert np.sum(area * patch.closing) == pytest.approx(0.01 * edge**2, abs=2e-4)


def test_bulges_are_what_a_sphere_has_below_its_faces():
    """h^2/(6 R) is the mean of a face of side h at the pole."""
    radius, h = 35.0, 0.5
    x = h * np.array([0.0, 1.0, 1.0, 0.0])
    y = h * np.array([0.0, 0.0, 1.0, 1.0])
    z = radius - np.sqrt(radius**2 - x**2 - y**2)
    found = bulges(np.stack([x, y, z], axis=-1)[None], radius)
    assert found.min() > 0.0
    assert found[0] @ PARTS.sum(axis=1) / 4 == pytest.approx(h**2 / (6 * radius), rel=1e-3)


@pytest.mark.parametrize("slope", [0.0, 0.3])
@pytest.mark.parametrize("edge", [0.6, 5.0])
def test_the_work_is_what_the_bodies_lose(edge, slope):
    patch = Patch(0.01 * (X - edge), slope=slope)
    start, work = patch.kinetic, 0.0
    for _ in range(3):
        work += sum(patch.close()[1:3])
        patch.x += DT * patch.v
    assert work == pytest.approx(start - patch.kinetic, rel=1e-12)
    assert work > 0.0


def test_a_rim_is_told_of_when_its_nodes_meet():
    assert Patch(-0.01, rim=True).close()[3]
    assert not Patch(0.01, bulge=0.02, rim=True).close()[3]  # their faces only
    assert not Patch(-0.01).close()[3]
