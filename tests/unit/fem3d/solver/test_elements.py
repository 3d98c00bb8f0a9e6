"""Elements: the patch test, rigid motions, rank, bending, twist, and constant volume."""

import numpy as np
import pytest

from impactlab.fem3d.solver.elements import DISSIPATED, HOURGLASS_WORK, WORK
from impactlab.fem3d.solver.lattice import brick
from impactlab.model.material import Material

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
    # a constant strain is the same everywhere and leaves no force inside
    nodes, elements, inside = distorted
    body = make_body(nodes, elements, kind)
    forces = body.move_to(nodes + nodes @ (1e4 * GRADIENT).T)
    spread = np.ptp(body.stress().reshape(6, -1), axis=1)
    assert spread.max() < 1e-10 * np.abs(body.stress()).max()
    assert np.abs(forces[inside]).max() < 1e-10 * np.abs(forces).max()
    assert np.abs(forces.sum(axis=0)).max() < 1e-10 * np.abs(forces).max()
    # A motion that strains and hourglasses: half the last forces' work, as forces began at 0.
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    motion = 1e-7 * np.random.default_rng(2).standard_normal(nodes.shape)
    forces = body.move_to(nodes + motion)
    works = body.group.energies()
    total = works[WORK] + works[HOURGLASS_WORK]
    assert total == pytest.approx(0.5 * np.sum(forces * motion), rel=1e-5)
    assert works[WORK] > 0.0


def test_a_translation_strains_nothing(make_body, distorted, kind):
    nodes, elements, _ = distorted
    body = make_body(nodes, elements, kind)
    forces = body.move_to(nodes + np.array([3.0, -2.0, 5.0]))
    assert np.abs(body.stress()).max() < 1e-12 * G
    assert np.abs(forces).max() < 1e-12 * G
    # a quarter turn strains nothing to the third order of the step
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
    assert body.group.energies()[HOURGLASS_WORK] > 0.0
    np.testing.assert_allclose(forces, before @ rotation.T, atol=1e-3 * np.abs(before).max())


E, NU = 200e9, 0.3
LENGTH, WIDTH, DEPTH = 1.0, 0.1, 0.2


def stiffness(body):
    """Return the stiffness of the body as it is, (3n, 3n) in N/m, column by column."""
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


@pytest.mark.parametrize(
    ("law", "factor"),
    [
        ({"rate_coefficient": 40.4, "rate_exponent": 5.0}, 1 + (100 / 40.4) ** 0.2),
        ({"rate_sensitivity": 0.03, "reference_rate": 0.5}, 1 + 0.03 * np.log(200)),
    ],
    ids=["cowper_symonds", "johnson_cook"],
)
def test_an_element_pulled_at_a_constant_rate_has_the_stress_of_the_law(
    make_body, kind, law, factor
):
    """A true strain at 100 1/s that keeps the volume: one stress and its work everywhere."""
    sigma, rate, last, steps = 300e6, 100.0, 0.02, 400
    metal = {"density": 7800.0, "youngs_modulus": 200e9, "poissons_ratio": 0.3}
    line = np.linspace(0.0, 1.0, 3)
    nodes, elements = brick(line, line, line)
    body = make_body(nodes, elements, kind, Material(**metal, yield_stress=sigma, **law))
    for strain in np.linspace(0.0, last, steps + 1)[1:]:
        stretch = np.exp(strain * np.array([1.0, -0.5, -0.5]))
        body.move_to(nodes * stretch, dt=last / rate / steps)
    yields = sigma * factor
    assert 1.5 * body.deviators()[0] == pytest.approx(np.full_like(body.deviators()[0], yields))
    slipped = last - yields / (3 * G)
    works = body.group.energies()
    assert works[DISSIPATED] == pytest.approx(yields * slipped, rel=5e-3)
    stored = 0.5 * yields**2 / (3 * G)
    assert works[WORK] == pytest.approx(works[DISSIPATED] + stored, rel=1e-3)
