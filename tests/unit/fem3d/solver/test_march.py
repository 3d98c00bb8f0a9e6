"""A march: momentum and energy kept, and every reason to stop."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from impactlab.fem3d.solver import impact_mesh, solve_on
from impactlab.fem3d.solver.march import March
from impactlab.fem3d.solver.mesh import BEAM, SPHERE
from impactlab.fem3d.solver.system import System, ThreadPool
from impactlab.model.impact import paper_impact

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="thousands of elements")
IMPACT = paper_impact()


@pytest.fixture(scope="module")
def mesh():
    return impact_mesh(IMPACT, element_size=1.5e-3)


@pytest.fixture(scope="module")
def marched(mesh):
    """30 us at 5 m/s, in which no wave reaches the supports: system and history."""
    impact = replace(paper_impact(5.0), gravity=0.0)
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        return system, March(system, impact).run(30e-6)


def test_beam_and_sphere_exchange_momentum_and_lose_none(mesh, marched):
    system, _ = marched
    momentum = system.mass * system.v[:, 2]
    of = {
        body: momentum[np.unique(mesh.elements[mesh.body == body])].sum() for body in (BEAM, SPHERE)
    }
    start = -5.0 * IMPACT.sphere.total_mass / 4
    assert of[BEAM] + of[SPHERE] == pytest.approx(start, rel=1e-12)
    assert of[BEAM] < 0.02 * start
    # the force of the steps is what slows the sphere
    system, history = marched
    time, force, sphere, *_, velocity = history.table()
    ball = np.unique(mesh.elements[mesh.body == SPHERE])
    mean = -np.average(system.v[ball, 2], weights=system.mass[ball])
    assert velocity[-1] == pytest.approx(mean, rel=1e-12)
    centre = -np.average(system.x[ball, 2] - mesh.nodes[ball, 2], weights=system.mass[ball])
    step = time[-1] - time[-2]
    assert sphere[-1] + step * velocity[-1] == pytest.approx(centre, rel=1e-10)
    assert force.max() > 1e3
    # energy balances while steel flows and gaps close
    _, history = marched
    balance = np.array([entry.balance for entry in history.energies])
    first = 0.5 * IMPACT.sphere.total_mass * 25.0
    np.testing.assert_allclose(balance, first, rtol=2e-5)
    last = history.energies[-1]
    assert last.plastic_work > 0.01 * first
    assert last.contact_work > 0.0
    assert last.strain_work > last.plastic_work


def test_a_contact_that_leaves_the_patch_stops_the_run_and_tells_the_radius():
    small = impact_mesh(IMPACT, element_size=0.5e-3, patch=1e-3, coarsest=8e-3, ratio=2.0)
    run = solve_on(small, IMPACT, duration=1e-3)
    needed = run.attrs["patch_needed"]
    assert 1.5e-3 < needed < 6e-3  # the contact's radius is 1.8 mm in the end
    told = f"grown beyond the matched patch of 1 mm: take patch = {needed:.4g} m or more"
    assert run.attrs["stopped"].endswith(told)
    assert 0.0 < run["duration"] < 1e-3
    assert run["contact_force"].max() > 0.0


def test_what_is_interrupted_is_kept(mesh):
    def stop(share):
        if share > 0.4:
            raise KeyboardInterrupt

    answer = solve_on(mesh, IMPACT, duration=20e-6, progress=stop, samples=10)
    assert "interrupted at" in answer.attrs["stopped"]
    assert float(answer["duration"]) == pytest.approx(8e-6, rel=0.1)
    assert float(answer["contact_force"].max()) > 0.0
    assert float(answer["checkpoint_time"][-1]) < 9e-6

    # what is interrupted before there is anything is not kept
    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_on(mesh, IMPACT, duration=1e-6, progress=stop)  # a hundredth of it is no step
    # less than a step is refused
    with pytest.raises(ValueError, match=r"solve\.duration = 1e-08 s: must be longer than a step"):
        solve_on(mesh, IMPACT, duration=1e-8)


def test_a_run_that_diverges_says_so_and_answers_nothing(mesh):
    with ThreadPool(1) as pool:
        system = System(mesh, IMPACT, pool)
        march = March(system, IMPACT)
        system.v[mesh.axis_node, 0] = np.inf
        history = march.run(5e-6)
    assert "diverged" in history.stopped
    assert len(history.energies) == 1


def test_nodes_that_slide_from_each_other_stop_the_run(mesh, monkeypatch):
    monkeypatch.setattr("impactlab.fem3d.solver.march._SLID", 1e-4)
    fast = paper_impact(5.0)
    with ThreadPool(1) as pool:
        history = March(System(mesh, fast, pool), fast).run(50e-6)
    assert "had slid by an element" in history.stopped
    assert history.offset > 1e-4
    assert history.moments[-1].time < 49e-6


def test_a_squeezed_element_stops_the_run(mesh):
    with ThreadPool(1) as pool:
        system = System(mesh, IMPACT, pool)
        march = March(system, IMPACT)
        system.x[mesh.axis_node, 2] += 3e-3
        history = march.run(5e-6)
    assert "was squeezed" in history.stopped
    assert "larger elements or a lower velocity" in history.stopped
