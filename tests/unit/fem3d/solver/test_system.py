"""Masses, the largest stable step, and the same bits for any number of threads."""

from dataclasses import replace

import numba
import numpy as np
import pytest
import xarray as xr

from impactlab.fem3d.solver import estimate, impact_mesh, solve_on
from impactlab.fem3d.solver.march import SAFETY
from impactlab.fem3d.solver.mesh import BEAM, SPHERE, nodal_masses
from impactlab.fem3d.solver.system import System, ThreadPool, critical_step
from impactlab.model.impact import paper_impact

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="thousands of elements")
IMPACT = paper_impact()


@pytest.fixture(scope="module")
def mesh():
    return impact_mesh(IMPACT, element_size=1.5e-3)


def test_a_quarter_weighs_a_quarter_and_the_sphere_what_it_is_said_to(mesh):
    heavy = replace(IMPACT, sphere=replace(IMPACT.sphere, mass=2.5))
    mass = nodal_masses(mesh, heavy)
    sphere = np.unique(mesh.elements[mesh.body == SPHERE])
    beam = np.unique(mesh.elements[mesh.body == BEAM])
    assert mass[sphere].sum() == pytest.approx(2.5 / 4, rel=1e-12)
    assert mass[beam].sum() == pytest.approx(7800 * 0.78 * 0.06 * 0.0278 / 4, rel=1e-12)
    # the critical step leaves the system as it was
    with ThreadPool(1) as pool:
        one, other = System(mesh, IMPACT, pool), System(mesh, IMPACT, pool)
        critical_step(one)
    for name in ("x", "v", "forces"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert not any(group.state.any() for group in one.groups)


def test_nodes_go_on_below_the_critical_step_and_run_away_above_it(mesh):
    with ThreadPool(1) as pool:
        system = System(mesh, IMPACT, pool)
        limit = critical_step(system)
        largest = {}
        for share in (0.97, 1.04):
            system = System(mesh, IMPACT, pool)
            system.v[:] = 1e-6 * np.random.default_rng(0).standard_normal(system.v.shape)
            system.v[system.inverse_mass == 0.0] = 0.0
            system.pull[:] = 0.0
            system.x[np.unique(mesh.elements[mesh.body == SPHERE]), 2] += 1e-3  # no contact
            for _ in range(200):
                system.strain(share * limit)
                system.move(share * limit, share * limit)
            largest[share] = np.abs(system.v).max()
    assert largest[0.97] < 1e-4
    assert not largest[1.04] < 1.0


@pytest.mark.parametrize("mass", [None, 0.1, 10.0])
def test_the_estimate_of_memory_and_steps_holds(mesh, mass):
    impact = replace(IMPACT, sphere=replace(IMPACT.sphere, mass=mass))
    cost = estimate(mesh, impact, duration=1e-3)
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        steps = 1e-3 / (SAFETY * critical_step(system))
    arrays = list(vars(system).values())
    arrays += [value for group in system.groups for value in vars(group).values()]
    arrays += [*system.assembly.of_groups, system.assembly.starts, system.assembly.slots]
    held = sum(array.nbytes for array in arrays if isinstance(array, np.ndarray))
    assert held < cost.memory_bytes < 2.5 * held
    assert cost.steps == pytest.approx(steps, rel=0.15)


def test_the_same_bits_for_any_number_of_threads(mesh):
    answers = [
        solve_on(mesh, IMPACT, duration=15e-6, threads=threads, samples=50) for threads in (1, 2, 3)
    ]
    assert float(answers[0]["contact_force"].max()) > 100.0
    for other in answers[1:]:
        xr.testing.assert_identical(answers[0].drop_attrs(deep=False), other.drop_attrs(deep=False))
