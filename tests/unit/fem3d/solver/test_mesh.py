"""The quarter model's mesh: graded lines; whole, conforming, matched, and of the bodies' volume."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from impactlab.fem3d.solver import estimate, impact_mesh
from impactlab.fem3d.solver.estimates import contact_radius
from impactlab.fem3d.solver.mesh import BEAM, CORNERS, SPHERE, graded
from impactlab.model.impact import paper_impact


@pytest.mark.parametrize("length", [4.2, 5.0, 11.7, 390.0])
def test_fine_first_then_growing_by_no_more_than_the_ratio(length):
    points = graded(0.5, 3.0, length, 1.3, 4.0)
    steps = np.diff(points)
    assert points[0] == 0.0
    assert points[-1] == length
    np.testing.assert_allclose(points[:7], 0.5 * np.arange(7))
    assert steps.min() > 0.45
    assert steps.max() <= 4.0 * (1 + 1e-9)
    assert np.all(steps[7:] / steps[6:-1] < 1.3 * (1 + 1e-9))
    assert np.all(steps[7:] >= steps[6:-1] * (1 - 1e-9))


def test_what_is_fine_all_along_is_even():
    np.testing.assert_allclose(graded(0.4, 3.0, 2.0, 1.3, 4.0), np.linspace(0.0, 2.0, 6))


RADIUS, SPAN, WIDTH, DEPTH = 0.035, 0.78, 0.06, 0.0278
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@pytest.fixture(scope="module")
def mesh():
    return impact_mesh(paper_impact(), element_size=1.5e-3)


def volumes(mesh):
    """Return each element's volume by Gauss's rule, exact for hexahedra with straight edges."""
    points, result = mesh.nodes[mesh.elements], 0.0
    for place in CORNERS / np.sqrt(3.0):
        one = 1.0 + CORNERS * place
        slopes = np.stack(
            [CORNERS[:, a] * np.prod(np.delete(one, a, axis=1), axis=1) / 8 for a in range(3)]
        )
        result = result + np.linalg.det(slopes @ points)
    return result


def outside(mesh, body):
    """Faces that one element alone has, as node tuples turning outwards."""
    faces = [tuple(e[list(f)]) for e in mesh.elements[mesh.body == body] for f in FACES]
    count = Counter(tuple(sorted(face)) for face in faces)
    assert set(count.values()) == {1, 2}
    return np.array([face for face in faces if count[tuple(sorted(face))] == 1])


def test_beam_fills_its_quarter_and_the_sphere_nearly_so(mesh):
    volume = volumes(mesh)
    assert volume[mesh.body == BEAM].sum() == pytest.approx(SPAN / 2 * WIDTH / 2 * DEPTH)
    ball = np.pi / 3 * RADIUS**3
    coarse = 1.0 - volume[mesh.body == SPHERE].sum() / ball
    fine = impact_mesh(paper_impact(), element_size=0.75e-3, coarsest=DEPTH / 12)
    finer = 1.0 - volumes(fine)[fine.body == SPHERE].sum() / ball
    assert 0.0 < finer < coarse < 0.02
    # every node is used and no two are in one place
    assert np.array_equal(np.unique(mesh.elements), np.arange(len(mesh.nodes)))
    for body in (BEAM, SPHERE):
        own = mesh.nodes[np.unique(mesh.elements[mesh.body == body])]
        assert len(np.unique(np.round(own, 9), axis=0)) == len(own)
    # elements conform and outer faces are where the bodies end
    x, y, z = mesh.nodes[outside(mesh, BEAM)].transpose(2, 0, 1)
    ends = [(x, 0.0), (x, SPAN / 2), (y, 0.0), (y, WIDTH / 2), (z, 0.0), (z, -DEPTH)]
    on = [np.all(np.abs(value - end) < 1e-12, axis=1) for value, end in ends]
    assert np.all(np.sum(on, axis=0) == 1)
    points = mesh.nodes[outside(mesh, SPHERE)]
    distance = np.linalg.norm(points - [0.0, 0.0, RADIUS], axis=2)
    ball = np.all(np.abs(distance - RADIUS) < 1e-12, axis=1)
    planes = [np.all(points[:, :, axis] == 0.0, axis=1) for axis in (0, 1)]
    assert np.all(ball + planes[0] + planes[1] == 1)


def test_pairs_share_their_place_and_gap_as_a_sphere_does(mesh):
    above, below = mesh.nodes[mesh.pairs].transpose(1, 0, 2)
    np.testing.assert_array_equal(above[:, :2], below[:, :2])
    assert np.all(below[:, 2] == 0.0)
    radius = np.hypot(above[:, 0], above[:, 1])
    np.testing.assert_allclose(
        mesh.gaps, RADIUS - np.sqrt(RADIUS**2 - radius**2), rtol=1e-9, atol=1e-17
    )
    assert mesh.gaps.min() == 0.0
    to_centre = np.array([0.0, 0.0, RADIUS]) - above
    np.testing.assert_allclose(np.cross(mesh.normals, to_centre), 0.0, atol=1e-12 * RADIUS)
    assert np.all(mesh.normals[:, 2] == 1.0)
    side = np.max(above[:, :2], axis=1)
    np.testing.assert_array_equal(mesh.rim, side > mesh.patch - 1e-9)
    inside = np.all(np.abs(mesh.nodes[:, :2]) < mesh.patch + 1e-9, axis=1) & (
        np.abs(mesh.nodes[:, 2]) < 1e-15
    )
    assert inside.sum() == len(mesh.pairs) + 1  # the pole, too, is at z = 0
    # named nodes are where they should be
    assert np.all(mesh.nodes[mesh.symmetry_x, 0] == 0.0)
    assert np.all(mesh.nodes[mesh.symmetry_y, 1] == 0.0)
    np.testing.assert_allclose(
        mesh.nodes[mesh.support][:, [0, 2]], [[SPAN / 2, -DEPTH / 2]] * len(mesh.support)
    )
    assert mesh.nodes[mesh.support, 1].max() == WIDTH / 2
    np.testing.assert_allclose(mesh.nodes[mesh.axis_node], [0.0, 0.0, -DEPTH / 2])
    assert np.array_equal(mesh.nodes[mesh.pole], [0.0, 0.0, 0.0])
    assert np.array_equal(mesh.nodes[mesh.top_node], [0.0, 0.0, 0.0])


def test_an_inverted_element_is_named(mesh):
    nodes = mesh.nodes.copy()
    nodes[mesh.axis_node, 2] += 0.02
    with pytest.raises(ValueError, match=r"inverted.*smaller element_size"):
        replace(mesh, nodes=nodes)


@pytest.mark.parametrize("depth", [4.002, 4.2, 6.02, 6.9, 7.37, 8.3, 10.1, 27.8])
def test_no_layer_is_much_thinner_than_the_elements_of_the_contact(depth):
    paper = paper_impact()
    impact = replace(paper, beam=replace(paper.beam, depth=1e-3 * depth))
    fine = impact_mesh(impact, element_size=1e-3, patch=3e-3)
    layers = np.diff(np.unique(fine.nodes[fine.elements[fine.body == BEAM], 2]))
    assert layers.min() > 0.65e-3
    assert layers.sum() == pytest.approx(1e-3 * depth)


def test_an_estimated_patch_gives_up_its_margin_where_the_bodies_end():
    paper = paper_impact(velocity=20.0)
    narrow = replace(paper, beam=replace(paper.beam, width=0.03))
    assert contact_radius(narrow) < 0.9 * 0.015 < 14e-3  # what 1.25 of it would be
    assert impact_mesh(narrow, element_size=1e-3).patch == pytest.approx(13e-3)
    narrower = replace(paper, beam=replace(paper.beam, width=0.02))
    assert contact_radius(narrower) > 0.9 * 0.01
    with pytest.raises(ValueError, match=r"must be at most 0\.009 m to fit"):
        impact_mesh(narrower, element_size=1e-3)
    # a patch beyond the bodies is refused
    with pytest.raises(ValueError, match=r"mesh\.patch = 0\.0"):
        impact_mesh(paper_impact(), element_size=1e-3, patch=0.02)


def test_a_faster_impact_has_a_wider_patch_and_its_middle_fully_integrated():
    slow, fast = (impact_mesh(paper_impact(v), element_size=1.5e-3) for v in (0.99, 10.0))
    assert fast.patch > 2.0 * slow.patch
    centres = fast.nodes[fast.elements].mean(axis=1)
    middle = (fast.body == BEAM) & (centres[:, 0] < DEPTH)
    assert np.all(fast.full[middle])
    assert not np.all(slow.full[(slow.body == BEAM) & (centres[:1, 0] < DEPTH)])


def test_cost_grows_with_the_fourth_power_at_most(mesh):
    coarse = estimate(mesh, paper_impact(), duration=1e-3)
    fine = estimate(
        impact_mesh(paper_impact(), element_size=0.75e-3), paper_impact(), duration=1e-3
    )
    assert coarse.elements == len(mesh.elements)
    assert fine.steps == pytest.approx(2 * coarse.steps, rel=0.1)
    assert 2.0 < fine.cpu_seconds / coarse.cpu_seconds < 16.0
    assert fine.memory_bytes > coarse.memory_bytes
