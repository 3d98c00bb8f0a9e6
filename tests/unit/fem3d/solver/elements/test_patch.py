"""The patch test, and rigid motions: what every element has to pass."""

from __future__ import annotations

import numpy as np
import pytest

G, K = 200e9 / 2.6, 200e9 / 1.2
GRADIENT = 1e-7 * np.array([[1.0, -0.4, 0.3], [0.7, 0.5, -0.6], [-0.2, 0.9, -1.1]])


def six(tensor):
    return np.array([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))])


def turn(axis, angle):
    """Rodrigues' rotation."""
    n = np.array(axis) / np.linalg.norm(axis)
    W = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return np.eye(3) + np.sin(angle) * W + (1 - np.cos(angle)) * W @ W


def test_a_constant_strain_is_met_by_hookes_stress(make_body, distorted, kind):
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    body.move_to(nodes + nodes @ GRADIENT.T)
    strain = 0.5 * (GRADIENT + GRADIENT.T)
    hooke = six(2 * G * strain + (K - 2 / 3 * G) * np.trace(strain) * np.eye(3))
    error = body.stress() - hooke[:, None, None]
    assert np.abs(error).max() < 1e-6 * np.abs(hooke).max()  # the strain is finite


def test_a_constant_strain_is_the_same_everywhere_and_leaves_no_force_inside(
    make_body, distorted, kind
):
    nodes, elements, inside = distorted
    body = make_body(nodes, elements, kind)
    forces = body.move_to(nodes + nodes @ (1e4 * GRADIENT).T)
    spread = np.ptp(body.stress().reshape(6, -1), axis=1)
    assert spread.max() < 1e-10 * np.abs(body.stress()).max()
    assert np.abs(forces[inside]).max() < 1e-10 * np.abs(forces).max()
    assert np.abs(forces.sum(axis=0)).max() < 1e-10 * np.abs(forces).max()


def test_work_of_the_forces_is_the_work_in_the_elements(make_body, distorted, kind):
    """A motion that strains and hourglasses: half the last forces' work, as forces began at 0."""
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    motion = 1e-7 * np.random.default_rng(2).standard_normal(nodes.shape)
    forces = body.move_to(nodes + motion)
    kinds = (body.kind.WORK, body.kind.HOURGLASS_WORK)
    work = sum(body.group.row(row).sum() for row in kinds)
    assert work == pytest.approx(0.5 * np.sum(forces * motion), rel=1e-5)
    assert np.all(body.group.row(body.kind.WORK) > 0.0)


def test_a_translation_strains_nothing(make_body, distorted, kind):
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    forces = body.move_to(nodes + np.array([3.0, -2.0, 5.0]))
    assert np.abs(body.stress()).max() < 1e-12 * G
    assert np.abs(forces).max() < 1e-12 * G


def test_a_quarter_turn_strains_nothing_to_the_third_order_of_the_step(make_body, distorted, kind):
    nodes, elements, _ = distorted
    left = []
    for steps in (50, 100):
        body = make_body(nodes, elements, kind)
        for step in range(1, steps + 1):
            body.move_to(nodes @ turn([1.0, 2.0, -0.5], 0.5 * np.pi * step / steps).T)
        left.append(np.abs(body.stress()).max() / (2 * G))
    assert left[1] < 5e-6
    assert left[0] / left[1] > 7.0


def test_a_stress_turns_with_the_body_and_nothing_else_happens(make_body, distorted, kind):
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    strained = nodes + nodes @ (1e4 * GRADIENT).T
    before = body.move_to(strained)
    stress = body.stress()[:, 0, 0]
    tensor = np.array(
        [
            [stress[0], stress[5], stress[4]],
            [stress[5], stress[1], stress[3]],
            [stress[4], stress[3], stress[2]],
        ]
    )
    for step in range(1, 101):
        rotation = turn([1.0, 2.0, -0.5], 0.25 * np.pi * step / 100)
        forces = body.move_to(strained @ rotation.T)
    turned = six(rotation @ tensor @ rotation.T)
    largest = np.abs(stress).max()
    np.testing.assert_allclose(
        body.stress(),
        np.broadcast_to(turned[:, None, None], body.stress().shape),
        atol=6e-4 * largest,
    )
    np.testing.assert_allclose(forces, before @ rotation.T, atol=6e-4 * np.abs(before).max())


def test_hourglass_forces_turn_with_the_body(make_body, distorted):
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, "one_point")
    shape = 1e-3 * nodes[:, [1, 2, 0]] * nodes[:, [2, 0, 1]]
    before = body.move_to(nodes + shape)
    for step in range(1, 201):
        rotation = turn([0.3, -1.0, 0.8], 0.5 * np.pi * step / 200)
        forces = body.move_to((nodes + shape) @ rotation.T)
    assert np.all(body.group.row(body.kind.HOURGLASS_WORK) > 0.0)
    np.testing.assert_allclose(forces, before @ rotation.T, atol=1e-3 * np.abs(before).max())
