"""The elements' stiffness: rank, bending, twist, and volume kept."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.fem3d.solver.mesh.mesh import brick
from impactlab.model.material import Material

E, NU = 200e9, 0.3
LENGTH, WIDTH, DEPTH = 1.0, 0.1, 0.2


def stiffness(body):
    """Of the body as it is, (3n, 3n) in N/m, column by column."""
    nodes = body.x.copy()
    columns = []
    for place in np.ndindex(nodes.shape):
        body.group.state[:] = 0.0
        body.x = nodes.copy()
        moved = nodes.copy()
        moved[place] += 1e-9
        columns.append(body.move_to(moved).ravel() / 1e-9)
    body.x = nodes
    body.group.state[:] = 0.0
    return np.array(columns).T


def bent(make_body, kind, cells, moment, axis=2):
    """Curvature (1/m) at the middle of a bar under end moments (N m) about y or z."""
    lines = [
        np.linspace(0.0, size, count + 1)
        for size, count in zip((LENGTH, WIDTH, DEPTH), cells, strict=True)
    ]
    body = make_body(*brick(*lines), kind)
    nodes = body.x
    K = stiffness(body)
    arm = nodes[:, axis] - nodes[:, axis].mean()
    force = np.zeros_like(nodes)
    for end, sign in ((0.0, -1.0), (LENGTH, 1.0)):
        on = nodes[:, 0] == end
        share = arm * on * _tributary(nodes, on)
        force[:, 0] += sign * moment * share / np.sum(share * arm)
    u = np.linalg.lstsq(K, force.ravel(), rcond=1e-12)[0].reshape(-1, 3)
    ends = [np.polyfit(arm[nodes[:, 0] == x], u[nodes[:, 0] == x, 0], 1)[0] for x in (0.0, LENGTH)]
    return (ends[1] - ends[0]) / LENGTH


def _tributary(nodes, on):
    """Areas of the nodes of an end face, up to a factor."""
    weights = np.ones(len(nodes))
    for axis in (1, 2):
        edge = (nodes[:, axis] == nodes[:, axis].min()) | (nodes[:, axis] == nodes[:, axis].max())
        weights *= np.where(edge, 0.5, 1.0)
    return weights * on


@pytest.mark.parametrize("cells", [(4, 1, 1), (4, 1, 2), (5, 2, 1)])
@pytest.mark.parametrize("axis", [1, 2])
def test_a_bar_of_one_point_elements_bends_as_euler_and_bernoulli_say(make_body, cells, axis):
    """The hourglass stiffness alone carries a moment where one element spans the depth."""
    inertia = WIDTH * DEPTH**3 / 12 if axis == 2 else DEPTH * WIDTH**3 / 12
    curvature = bent(make_body, "one_point", cells, 1e3, axis)
    assert curvature == pytest.approx(1e3 / (E * inertia), rel=0.02)


def test_nothing_moves_freely_but_a_rigid_body(make_body, kind):
    nodes, elements = brick(np.array([0.0, 1.0]), np.array([0.0, 0.7]), np.array([0.0, 0.4]))
    nodes = nodes + np.random.default_rng(0).uniform(-0.1, 0.1, nodes.shape)
    K = stiffness(make_body(nodes, elements, kind))
    np.testing.assert_allclose(K, K.T, atol=1e-6 * np.abs(K).max())
    values = np.sort(np.linalg.eigvalsh(0.5 * (K + K.T)))
    assert np.abs(values[:6]).max() < 1e-5 * values[-1]
    assert values[6] > 1e-3 * values[-1]


def test_a_cube_has_the_exact_stiffness_against_uniform_strains_and_twist(make_body):
    """Twist about x, u = (0, -xz, xy): Saint-Venant's with warping kept from it, G J."""
    side = np.array([-1.0, 1.0])
    body = make_body(*brick(side, side, side), "one_point")
    x, y, z = body.x.T
    u = 1e-6 * np.stack([0 * x, -x * z, x * y], axis=1)
    work = np.sum(u * body.move_to(body.x + u)) / 2
    G = E / (2 * (1 + NU))
    polar = 2 * (2.0 * 2.0**3 / 12)
    assert work == pytest.approx(0.5 * G * polar * 2.0 * 1e-12, rel=1e-4)


def test_full_elements_keep_their_volume_without_locking(make_body):
    """Near nu = 1/2 only the change of the mean dilatation costs, not that of single points."""
    rubber = Material(density=1.0, youngs_modulus=3e6, poissons_ratio=0.4999, yield_stress=2e6)
    side = np.array([-1.0, 1.0])
    body = make_body(*brick(side, side, side), "full", rubber)
    x, _, z = body.x.T
    u = 1e-6 * np.stack([x * z, 0 * x, 0 * x], axis=1)  # dilates above, contracts below
    work = np.sum(u * body.move_to(body.x + u)) / 2
    G = 3e6 / (2 * 1.4999)
    deviator = 2 * G * (2 / 3) / 2 * 8 / 3 * 1e-12
    shear = G / 2 * 8 / 3 * 1e-12
    assert work == pytest.approx(deviator + shear, rel=1e-3)
