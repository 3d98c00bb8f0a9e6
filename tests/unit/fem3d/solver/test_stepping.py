"""The assembly of forces, and Saint-Venant's impact of two bars, small enough for plain Python."""

import numpy as np
import pytest

from impactlab.fem3d.solver.elements import blocks_of
from impactlab.fem3d.solver.hexahedron import W
from impactlab.fem3d.solver.impulses import SHAPE
from impactlab.fem3d.solver.march import March
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh, brick
from impactlab.fem3d.solver.system import MOST_THREADS, ForceAssembly, Group, System, ThreadPool
from impactlab.model.bodies import Beam, Sphere
from impactlab.model.impact import Impact
from impactlab.model.material import Material


def two_groups():
    """Return groups of 11 and of 979 elements, all of one brick."""
    nodes, elements = brick(np.arange(11.0), np.arange(12.0), np.arange(10.0))
    numbers = np.split(np.arange(len(elements)), [11])
    groups = [
        Group(elements, which, whole, STEEL)
        for which, whole in zip(numbers, (True, False), strict=True)
    ]
    return len(nodes), groups


def test_every_corner_adds_to_a_row_of_its_node():
    nodes, groups = two_groups()
    rows = ForceAssembly(groups, nodes)
    owner = np.full(rows.count, -1)
    owner[rows.slots] = np.repeat(np.arange(nodes), np.diff(rows.starts))
    for group, own in zip(groups, rows.of_groups, strict=True):
        corners, found = (
            array.reshape(-1, 8, W).transpose(0, 2, 1).reshape(-1, 8)
            for array in (group.nodes, own)
        )
        count = group.elements.size
        np.testing.assert_array_equal(owner[found[:count]], corners[:count])
        assert np.all(owner[found[count:]] == -1)  # these fill the last block


def test_pieces_share_no_row():
    nodes, groups = two_groups()
    rows = ForceAssembly(groups, nodes)
    pieces = [
        set(own[slice(*blocks_of(len(own), piece, MOST_THREADS))].ravel().tolist())
        for group, own in zip(groups, rows.of_groups, strict=True)
        for piece in range(MOST_THREADS)
    ]
    assert sum(map(len, pieces)) == len(set().union(*pieces)) == rows.count
    # blocks are all shared out in their order
    _, (_, group) = two_groups()
    ends = [blocks_of(len(group.nodes), piece, MOST_THREADS) for piece in range(MOST_THREADS)]
    assert ends[0][0] == 0
    assert ends[-1][1] == len(group.nodes)
    assert [end for _, end in ends[:-1]] == [first for first, _ in ends[1:]]


STEEL = Material(density=8000.0, youngs_modulus=200e9, poissons_ratio=0.0, yield_stress=1e11)
SPEED, SIDE, CELLS, VELOCITY = 5000.0, 0.01, 15, 2.0
LENGTH = CELLS * SIDE
FORCE = 4 * 0.5 * 8000.0 * SPEED * SIDE**2 * VELOCITY
"""Of four quarters: rho c A v/2."""
DURATION = 2 * LENGTH / SPEED


def bars(full):
    """An upper bar on a lower one, with one-point or full elements."""
    side, line = np.array([0.0, SIDE]), np.linspace(-LENGTH, 0.0, CELLS + 1)
    lower, elements = brick(side, side, line)
    count = len(lower)
    nodes = np.concatenate([lower, lower + np.array([0.0, 0.0, LENGTH])])
    pairs = np.stack(
        [np.arange(4) * (CELLS + 1) + count, np.arange(4) * (CELLS + 1) + CELLS], axis=1
    )
    none = np.empty(0, dtype=np.int32)
    return Mesh(
        nodes=nodes,
        elements=np.concatenate([elements, elements + count]),
        body=np.repeat([BEAM, SPHERE], CELLS).astype(np.int32),
        full=np.full(2 * CELLS, full),
        pairs=pairs.astype(np.int32),
        gaps=np.zeros(4),
        rim=np.zeros(4, dtype=bool),
        bulge=np.zeros((1, len(SHAPE))),
        normals=np.tile([0.0, 0.0, 1.0], (4, 1)),
        copies=4,
        faces=np.array([[0, 2, 3, 1]], dtype=np.int32),
        symmetry_x=none,
        symmetry_y=none,
        support=none,
        clamped=none,
        ends=("free", "free"),
        axis_node=0,
        element_size=SIDE,
        patch=SIDE,
    )


@pytest.mark.parametrize("full", [False, True])
def test_bars_push_with_the_force_of_their_waves_and_part_when_these_return(full):
    impact = Impact(
        sphere=Sphere(radius=0.1, material=STEEL, mass=4 * 8000.0 * SIDE**2 * LENGTH),
        beam=Beam(span=1.0, width=0.1, depth=0.1, material=STEEL),
        velocity=VELOCITY,
        gravity=0.0,
    )
    with ThreadPool(1) as pool:
        system = System(bars(full), impact, pool)
        history = March(system, impact).run(1.5 * DURATION)
    time, force, *_ = history.table()
    assert force[(time > 0.2 * DURATION) & (time < 0.8 * DURATION)].mean() == pytest.approx(
        FORCE, rel=0.02
    )
    assert time[force > 0.5 * FORCE].max() == pytest.approx(DURATION, rel=0.05)
    velocities = [np.average(system.v[half, 2]) for half in np.split(np.arange(len(system.v)), 2)]
    np.testing.assert_allclose(velocities, [-VELOCITY, 0.0], atol=0.05 * VELOCITY)
    balance = np.array([entry.balance for entry in history.energies])
    np.testing.assert_allclose(balance, 0.5 * impact.sphere.total_mass * VELOCITY**2, rtol=1e-4)
