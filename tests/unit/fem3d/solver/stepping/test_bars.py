"""Two bars that meet end to end: Saint-Venant's impact, on few enough elements for plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.fem3d.solver.mesh import BEAM, SPHERE, Mesh
from impactlab.fem3d.solver.mesh.mesh import brick
from impactlab.fem3d.solver.stepping.march import March
from impactlab.fem3d.solver.stepping.system import System, ThreadPool
from impactlab.model.beam import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.model.sphere import Sphere

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
        symmetry_x=none,
        symmetry_y=none,
        support=none,
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
